# Another processor's Linux, run by QEMU's user mode: for its byte order or word length.
#
# Set before: target_tools (the compiler's prefix), target_flags, and target_emulator.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${target_tools}-gcc)
set(CMAKE_C_FLAGS_INIT "${target_flags}")
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(CMAKE_CROSSCOMPILING_EMULATOR ${target_emulator})
