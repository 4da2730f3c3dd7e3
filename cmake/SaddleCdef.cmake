# saddle_cdef(NAME OUTPUT h INCLUDES folder... HEADERS h...)
#
# Target NAME: the declarations of HEADERS and of what they include, as cffi reads them. The
# preprocessor sees empty standard headers, since cffi knows their types itself.
include_guard(GLOBAL)

function(saddle_cdef name)
    cmake_parse_arguments(PARSE_ARGV 1 CDEF "" "OUTPUT" "INCLUDES;HEADERS")
    set(standard ${PROJECT_BINARY_DIR}/standard)
    foreach(header IN ITEMS stdint.h stdbool.h stddef.h)
        file(WRITE ${standard}/${header} "")
    endforeach()
    set(headers ${CDEF_HEADERS})
    list(TRANSFORM headers PREPEND "-include;")
    list(TRANSFORM CDEF_INCLUDES PREPEND "-I")
    add_custom_command(
        OUTPUT ${CDEF_OUTPUT}
        COMMAND ${CMAKE_C_COMPILER} -E -P -nostdinc -DSADDLE_DECLARATIONS_ONLY -I${standard} ${CDEF_INCLUDES}
                -x c ${headers} /dev/null -o ${CDEF_OUTPUT}
        DEPENDS ${CDEF_HEADERS}
        COMMENT "Generating ${name}" VERBATIM)
    add_custom_target(${name} DEPENDS ${CDEF_OUTPUT})
endfunction()
