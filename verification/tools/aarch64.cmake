# Cross build for 64-bit Arm: cmake --preset release --toolchain verification/tools/aarch64.cmake -DDPDREF_SYSROOT=DIR,
# where DIR holds the packages of the README for arm64; machines.sh makes one. The tests run under qemu-user.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES DPDREF_SYSROOT)
set(CMAKE_SYSROOT ${DPDREF_SYSROOT})
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CXX_COMPILER_TARGET aarch64-linux-gnu)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR "qemu-aarch64;-L;${DPDREF_SYSROOT}")
set(CMAKE_FIND_ROOT_PATH ${DPDREF_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# where Debian's libhdf5-dev has it
set(CMAKE_LIBRARY_PATH ${DPDREF_SYSROOT}/usr/lib/aarch64-linux-gnu/hdf5/serial)
set(CMAKE_INCLUDE_PATH ${DPDREF_SYSROOT}/usr/include/hdf5/serial)
