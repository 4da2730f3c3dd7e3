# saddle_layer(NAME [HEADERS h...] [SOURCES c...] [USES layer...])
#
# One layer of the core. Its sources see their own headers and those of the layers that they USE,
# and no others: the public headers lie side by side in one folder, so each layer has a folder of
# links to its own, and only the folders of NAME and USES are on the include path. USES is not
# transitive, and a layer must be declared before it is used: arrows point down.
#
# The layers' objects are collected in the global property SADDLE_CORE_OBJECTS, their headers in
# SADDLE_CORE_HEADERS.
include_guard(GLOBAL)
include(${CMAKE_CURRENT_LIST_DIR}/SaddleStrict.cmake)

function(saddle_layer name)
    cmake_parse_arguments(PARSE_ARGV 1 LAYER "" "" "HEADERS;SOURCES;USES")
    set(public ${CMAKE_CURRENT_SOURCE_DIR}/include)
    set(view ${CMAKE_CURRENT_BINARY_DIR}/layers/${name})

    file(REMOVE_RECURSE ${view})
    file(MAKE_DIRECTORY ${view}/saddlewalk)
    foreach(header IN LISTS LAYER_HEADERS)
        file(CREATE_LINK ${public}/saddlewalk/${header} ${view}/saddlewalk/${header} SYMBOLIC)
        set_property(GLOBAL APPEND PROPERTY SADDLE_CORE_HEADERS ${public}/saddlewalk/${header})
    endforeach()
    add_library(saddle_view_${name} INTERFACE)
    target_include_directories(saddle_view_${name} INTERFACE ${view})

    if(LAYER_SOURCES)
        add_library(saddle_layer_${name} OBJECT)
        list(TRANSFORM LAYER_SOURCES PREPEND src/)
        target_sources(saddle_layer_${name} PRIVATE ${LAYER_SOURCES})
        set_target_properties(saddle_layer_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
        target_link_libraries(saddle_layer_${name} PRIVATE saddle_strict saddle_same_bits)
        foreach(seen IN ITEMS ${name} LISTS LAYER_USES)
            if(NOT TARGET saddle_view_${seen})
                message(FATAL_ERROR "layer ${name} uses ${seen}, which is not below it")
            endif()
            target_link_libraries(saddle_layer_${name} PRIVATE saddle_view_${seen})
        endforeach()
        set_property(GLOBAL APPEND PROPERTY SADDLE_CORE_OBJECTS
                     $<TARGET_OBJECTS:saddle_layer_${name}>)
    endif()
endfunction()
