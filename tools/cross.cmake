# Toolchain file for another architecture of Debian: FIELDCAST_ARCH is its name there, arm64 or armhf. The compiler is that of
# crossbuild-essential-ARCH, and the libraries are the multiarch packages of ARCH. Programs of ARCH that the build runs (for
# the manual pages) run by qemu-user through binfmt_misc.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES FIELDCAST_ARCH)
set(arm64 aarch64 aarch64-linux-gnu)
set(armhf armv7l arm-linux-gnueabihf)
list(GET ${FIELDCAST_ARCH} 0 CMAKE_SYSTEM_PROCESSOR)
list(GET ${FIELDCAST_ARCH} 1 triplet)

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${triplet}-gcc)
set(CMAKE_CXX_COMPILER ${triplet}-g++)
set(ENV{PKG_CONFIG_LIBDIR} /usr/lib/${triplet}/pkgconfig:/usr/share/pkgconfig)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${FIELDCAST_ARCH})
