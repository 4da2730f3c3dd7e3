# 32-bit x86. Its old FPU rounds to 80 bits; SSE keeps to single precision.
set(CMAKE_SYSTEM_PROCESSOR i686)
set(target_tools i686-linux-gnu)
set(target_flags "-msse2 -mfpmath=sse")
set(target_emulator qemu-i386-static)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
