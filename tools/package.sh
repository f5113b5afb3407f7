#!/usr/bin/env bash
# Builds the Debian packages fieldcast, fieldcast-dev, fieldcast-forward, fieldcast-sim and libfieldcast-station1 in build/packages.
#
#   tools/package.sh [--arch ARCH] [--suite SUITE] [--quick]
#
# Installs missing packages (tools/install.sh package). Prints the new files. With --arch (amd64, arm64 or armhf) or --suite (bookworm or
# trixie), builds in a root of that suite (tools/in_root.sh) and puts the packages in build/packages/SUITE-ARCH. For another
# architecture it compiles with crossbuild-essential-ARCH; only the manual pages are made by the new programs, under qemu-user.
# --quick: compiles with -O1, which takes two thirds of the time. Only for tests of the packages.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "tools/package.sh: $*" >&2; exit 1; }

here=$(dpkg --print-architecture) arch="" suite="" type=(-DCMAKE_BUILD_TYPE=RelWithDebInfo) quick=()
while [ $# -gt 0 ]; do
  case "$1" in
    --arch) arch=${2:-}; case "$arch" in amd64|arm64|armhf) ;; *) fail "'$arch' is not allowed; use amd64, arm64 or armhf" ;; esac ;;
    --suite) suite=${2:-}; case "$suite" in bookworm|trixie) ;; *) fail "'$suite' is not allowed; use bookworm or trixie" ;; esac ;;
    --quick) quick=(--quick) type=(-DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O1); shift; continue ;;
    *) sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
  esac
  shift 2
done

if [ -n "$arch$suite" ] && [ ! -f /etc/fieldcast-root ]; then
  suite=${suite:-$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)} arch=${arch:-$here}
  tools/emulator.sh "$arch" || fail "no manual pages for $arch, see above"
  packages=build/packages/$suite-$arch
  mkdir -p "$packages"
  tools/in_root.sh "$suite" "$here" -- sh -c 'tools/package.sh --arch "$@" >&2 && cd "build/packages/$1" && tar -c *.deb' sh "$arch" "${quick[@]}" |
    tar -x --no-same-owner -C "$packages"
  ls -l "$packages"/*.deb
  exit
fi

folder=build packages=build/packages${arch:+/$arch} options=("${type[@]}") host=()
if [ "${arch:-$here}" = "$here" ]; then
  tools/install.sh package
else
  folder=build-$arch
  options+=(-DCMAKE_TOOLCHAIN_FILE=tools/cross.cmake -DFIELDCAST_ARCH="$arch")
  host=(env DEB_HOST_ARCH="$arch")  # for dpkg-shlibdeps
  tools/install.sh cross "$arch"
fi
# Keeps the options of an existing build, so that tools/test.sh still builds its tests.
[ -f "$folder/CMakeCache.txt" ] || options+=(-DFIELDCAST_TESTS=OFF -DFIELDCAST_BENCHES=OFF)
tools/build.sh --folder "$folder" "${options[@]}" packaged
mkdir -p "$packages"
log=$packages.log
"${host[@]}" cpack --config "$folder/CPackConfig.cmake" -B "$packages" >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
ls -l "$packages"/*.deb
