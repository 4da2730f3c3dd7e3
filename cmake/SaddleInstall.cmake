# cmake --install: find_package(saddlewalk CONFIG) then has saddlewalk::core, saddlewalk::joints and
# saddlewalk::wire.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/saddlewalk)
install(TARGETS saddlewalk_core saddlewalk_joints saddlewalk_wire EXPORT saddlewalk
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY firmware/core/include/saddlewalk firmware/joints/include/saddlewalk
                  firmware/wire/include/saddlewalk
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES firmware/wire/saddlewalk.dbc DESTINATION ${CMAKE_INSTALL_DATADIR}/saddlewalk)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(EXPORT saddlewalk NAMESPACE saddlewalk:: FILE saddlewalk-config.cmake
        DESTINATION ${package})

set(version_file ${PROJECT_BINARY_DIR}/saddlewalk-config-version.cmake)
write_basic_package_version_file(${version_file} COMPATIBILITY SameMinorVersion)
install(FILES ${version_file} DESTINATION ${package})
