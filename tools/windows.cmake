# Toolchain file of the Windows program: mingw-w64 with POSIX threads, as tools/install.sh windows installs it. FIELDCAST_WINDOWS_ROOT
# has the headers of libraries and OpenSSL, which tools/windows.sh puts there.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES FIELDCAST_WINDOWS_ROOT)
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
