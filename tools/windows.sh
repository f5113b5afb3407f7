#!/usr/bin/env bash
# Builds fieldcast-port.exe and its installer for Windows with mingw-w64, in build-windows.
#
#   tools/windows.sh [--program]
#
# Installs missing packages (tools/install.sh windows). Downloads the source of OpenSSL from the package servers of this machine, which
# apt verifies, and builds it once; delete build-windows/root to build a newer one. --program: without the installer. Prints the two files
# with their sizes. The same commit, compiler and OpenSSL give the same bytes; nothing is signed.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "tools/windows.sh: $*" >&2; exit 1; }
installer=yes
case "${1:-}" in
  '') ;;
  --program) installer=no ;;
  *) sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac

tools/install.sh windows
folder=$PWD/build-windows
root=$folder/root  # what the compiler of Windows may see of libraries
host=x86_64-w64-mingw32
mkdir -p "$folder" "$root/include" "$root/lib"
log=$folder/openssl.log
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -c safe.directory="$PWD" log -1 --format=%ct)}
export SOURCE_DATE_EPOCH LC_ALL=C TZ=UTC

# Headers of libraries that need no compiled part. The folder of the system also has the headers of Linux, which must not be found.
for header in boost fmt CLI tl; do
  [ -e "/usr/include/$header" ] || fail "/usr/include/$header is missing"
  ln -sfn "/usr/include/$header" "$root/include/$header"
done

# The entries of Debian's archive in this machine's package sources, as sources of source packages.
write_sources() {  # FOLDER
  local file
  for file in /etc/apt/sources.list.d/*.sources; do
    [ ! -f "$file" ] || awk -v RS= -v ORS='\n\n' '/(^|\n)URIs: *[^\n]*\/debian(-security)?\/?( |\n|$)/ {
        sub(/(^|\n)Types:[^\n]*/, "\nTypes: deb-src"); print }' "$file" | sed '/^$/N;/^\n$/D' >"$1/$(basename "$file")"
  done
  { cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null || true; } |
    sed -nE 's#^deb(( +\[[^]]*\])? +[^ ]+/debian(-security)?/? .*)$#deb-src\1#p' >"$1/plain.list"
}

fetch_openssl() {  # prints the path of the tarball
  local lists sources options
  lists=$folder/apt sources=$folder/apt/sources
  rm -rf "$lists"
  mkdir -p "$lists/lists/partial" "$sources"
  write_sources "$sources"
  options=(-o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$sources" -o Dir::State::lists="$lists/lists"
           -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root)
  apt-get "${options[@]}" -q update >>"$log" 2>&1 || fail "the list of source packages cannot be downloaded; see $log"
  (cd "$lists" && apt-get "${options[@]}" -q source --download-only --tar-only openssl) >>"$log" 2>&1 ||
    fail "the source of OpenSSL cannot be downloaded; see $log"
  ls "$lists"/openssl_*.orig.tar.*z | tail -1
}

# Only TLS of a client: no engine, no other protocol. It reads no configuration file, because any user could create one in a folder
# outside of the program's (CVE-2019-1552).
build_openssl() {
  local tarball version source
  tarball=$(fetch_openssl)
  version=${tarball##*/openssl_} version=${version%.orig.tar.*}
  if [ -f "$root/openssl-$version" ] && [ -f "$root/lib/libssl.a" ]; then return; fi
  echo "tools/windows.sh: building OpenSSL $version, about six minutes" >&2
  source=$folder/openssl
  rm -rf "$source" "$root"/openssl-*
  mkdir -p "$source"
  tar -xf "$tarball" -C "$source" --strip-components=1
  (cd "$source" && CC=gcc-posix ./Configure mingw64 --cross-compile-prefix=$host- --prefix=/fieldcast --openssldir=/fieldcast/ssl --libdir=lib \
    no-shared no-tests no-engine no-dso no-async no-comp no-ssl3 no-tls1 no-tls1_1 no-dtls no-srp no-psk no-legacy no-idea no-camellia \
    no-seed no-aria no-sm2 no-sm3 no-sm4 no-bf no-cast no-des no-rc2 no-rc4 no-md4 no-mdc2 no-rmd160 no-whirlpool no-siphash \
    no-blake2 no-scrypt no-gost no-cms no-ts no-ct no-ocsp no-cmp no-capieng no-afalgeng no-autoload-config no-ui-console \
    -O2 -ffunction-sections -fdata-sections &&
    make -j"$(nproc)" build_libs) >>"$log" 2>&1 || fail "OpenSSL cannot be built; see $log"
  rm -rf "$root/include/openssl"
  cp -r "$source/include/openssl" "$root/include/openssl"
  cp "$source/libssl.a" "$source/libcrypto.a" "$root/lib/"
  rm -rf "$source"
  touch "$root/openssl-$version"
}
: >"$log"
[ -n "$(ls "$root"/openssl-* 2>/dev/null)" ] || build_openssl

tools/build.sh --folder build-windows -DCMAKE_TOOLCHAIN_FILE=tools/windows.cmake -DFIELDCAST_WINDOWS_ROOT="$root" fieldcast-port >&2
program=$folder/bin/fieldcast-port.exe
[ "$(stat -c %s "$program")" -le 6000000 ] || fail "$program is larger than 6 MB"
ls -l "$program"
[ "$installer" = yes ] || exit 0

# The licences of the libraries in the program, with the texts of Debian's packages.
files=$folder/installer packages=$folder/packages
rm -rf "$files"
mkdir -p "$files" "$packages"
cp "$program" "$files/"
sed 's/$/\r/' LICENSE >"$files/license.txt"
for package in openssl libboost-dev libfmt-dev libcli11-dev libexpected-dev mingw-w64-x86-64-dev gcc-mingw-w64-x86-64-posix-runtime; do
  [ -f "/usr/share/doc/$package/copyright" ] || fail "/usr/share/doc/$package/copyright is missing"
  printf '==== %s\n\n' "$package"
  cat "/usr/share/doc/$package/copyright"
done | sed 's/$/\r/' >"$files/notices.txt"
version=$(sed -n 's/^project(fieldcast VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
rm -f "$packages"/fieldcast-port-*-setup.exe
setup=$packages/fieldcast-port-$version-setup.exe
makensis -V2 -NOCD -DVERSION="$version" -DFILES="$files" -DOUTPUT="$setup" tools/program-port/windows/installer.nsi >&2
ls -l "$setup"
