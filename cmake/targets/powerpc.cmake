# Big-endian, 32 bits.
set(CMAKE_SYSTEM_PROCESSOR ppc)
set(target_tools powerpc-linux-gnu)
set(target_flags "")
set(target_emulator qemu-ppc-static)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
