# A bare-metal target: picolibc, images that print and exit through semihosting, run by QEMU.
#
# Set before: target_tools (the compiler's prefix), target_flags, target_memory (the linker's
# symbols) and target_machine (QEMU's command line).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_C_COMPILER ${target_tools}-gcc)
set(CMAKE_OBJDUMP ${target_tools}-objdump CACHE FILEPATH "")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_EXECUTABLE_SUFFIX .elf)

list(TRANSFORM target_memory PREPEND "-Wl,--defsym=__")
list(JOIN target_memory " " target_memory)
set(CMAKE_C_FLAGS_INIT "${target_flags} --specs=picolibc.specs -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT
    "--oslib=semihost --crt0=semihost -Wl,--gc-sections ${target_memory}")
set(CMAKE_CROSSCOMPILING_EMULATOR ${target_machine} -nographic -monitor none -serial null
    -semihosting-config enable=on,target=native -kernel)
