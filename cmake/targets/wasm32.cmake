# WebAssembly with WASI's C library; its programs are run by node.
set(CMAKE_SYSTEM_NAME WASI)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_C_COMPILER clang)
set(CMAKE_C_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CROSSCOMPILING_EMULATOR
    node --no-warnings ${CMAKE_CURRENT_LIST_DIR}/../../tests/targets/wasi.mjs)
