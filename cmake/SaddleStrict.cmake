# saddle_strict: how every C file of ours is compiled. C99 without extensions; warnings are errors,
# but not in a project that takes this one in and may have a newer compiler.
include_guard(GLOBAL)

add_library(saddle_strict INTERFACE)
target_compile_options(saddle_strict INTERFACE
    -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    -Wstrict-prototypes -Wmissing-prototypes
    $<$<STREQUAL:${CMAKE_PROJECT_NAME},saddlewalk>:-Werror>)

# saddle_same_bits: what makes one input give the same bits on every compiler and target. Float
# arithmetic alone, each operation rounded by itself. For what runs on a target, not for tests.
add_library(saddle_same_bits INTERFACE)
target_compile_options(saddle_same_bits INTERFACE
    -ffp-contract=off -fno-math-errno -Wdouble-promotion)
