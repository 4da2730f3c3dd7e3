# Without a floating-point unit: the compiler's own routines add and multiply.
set(target_tools arm-none-eabi)
set(target_flags "-mthumb -mcpu=cortex-m3 -mfloat-abi=soft")
set(target_memory flash=0 flash_size=4m ram=0x20000000 ram_size=4m stack_size=64k)
set(target_machine qemu-system-arm -M mps2-an385)
include(${CMAKE_CURRENT_LIST_DIR}/bare-metal.cmake)
