# saddle_public(NAME HEADER...)
#
# Headers of include/saddlewalk that a layer may use by that name.
#
# saddle_layer(ROOM/NAME [USES layer...])
#
# One layer of a library: src/ROOM/NAME.h and, if there is one, src/ROOM/NAME.c. It sees its own header
# and those of the layers that it USES, and no others: each layer has a folder of links to its
# headers, and only the folders of NAME and USES are on the include path. USES is not transitive, and
# a layer must be declared before it is used: arrows point down.
#
# The caller has set SADDLE_LIBRARY, as CORE. The layers' objects are collected in the global property
# SADDLE_CORE_LAYER_OBJECTS, the public headers in SADDLE_CORE_HEADERS, and the layers' names, from the
# lowest up, in SADDLE_CORE_LAYERS.
include_guard(GLOBAL)
include(${CMAKE_CURRENT_LIST_DIR}/SaddleStrict.cmake)

# A folder of links to the headers in FROM, and a target that has it on the include path.
function(saddle_view name from)
    string(REPLACE "/" "_" target saddle_view_${name})
    set(view ${CMAKE_CURRENT_BINARY_DIR}/layers/${name})
    file(REMOVE_RECURSE ${view})
    foreach(header IN LISTS ARGN)
        cmake_path(GET header PARENT_PATH folder)
        file(MAKE_DIRECTORY ${view}/${folder})
        file(CREATE_LINK ${from}/${header} ${view}/${header} SYMBOLIC)
    endforeach()
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${view})
endfunction()

function(saddle_public name)
    set(from ${CMAKE_CURRENT_SOURCE_DIR}/include)
    list(TRANSFORM ARGN PREPEND saddlewalk/)
    saddle_view(${name} ${from} ${ARGN})
    list(TRANSFORM ARGN PREPEND ${from}/)
    set_property(GLOBAL APPEND PROPERTY SADDLE_${SADDLE_LIBRARY}_HEADERS ${ARGN})
endfunction()

function(saddle_layer name)
    cmake_parse_arguments(PARSE_ARGV 1 LAYER "" "" "USES")
    set(from ${CMAKE_CURRENT_SOURCE_DIR}/src)
    if(EXISTS ${from}/${name}.h)
        saddle_view(${name} ${from} ${name}.h)
        list(PREPEND LAYER_USES ${name})
    endif()
    set_property(GLOBAL APPEND PROPERTY SADDLE_${SADDLE_LIBRARY}_LAYERS ${name})
    if(NOT EXISTS ${from}/${name}.c)
        return()
    endif()
    string(REPLACE "/" "_" target saddle_layer_${name})
    add_library(${target} OBJECT src/${name}.c)
    set_target_properties(${target} PROPERTIES
        POSITION_INDEPENDENT_CODE ON EXCLUDE_FROM_ALL ON)
    target_link_libraries(${target} PRIVATE saddle_strict saddle_same_bits)
    foreach(used IN LISTS LAYER_USES)
        string(REPLACE "/" "_" view saddle_view_${used})
        if(NOT TARGET ${view})
            message(FATAL_ERROR "layer ${name} uses ${used}, which is not below it")
        endif()
        target_link_libraries(${target} PRIVATE ${view})
    endforeach()
    set_property(GLOBAL APPEND PROPERTY SADDLE_${SADDLE_LIBRARY}_LAYER_OBJECTS
                 $<TARGET_OBJECTS:${target}>)
endfunction()
