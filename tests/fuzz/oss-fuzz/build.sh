#!/usr/bin/env bash
# Builds the fuzz targets of core as OSS-Fuzz does: $OUT/fuzz_NAME and $OUT/fuzz_NAME_seed_corpus.zip.
#
# Runs in the folder of the sources. OSS-Fuzz sets CXX, CXXFLAGS, LIB_FUZZING_ENGINE and OUT. Its programs use libc++, but Debian's
# libraries libstdc++: targets that need such a library are left out. To build here:
#
#   CXX=clang++ CXXFLAGS=-fsanitize=fuzzer-no-link,address LIB_FUZZING_ENGINE=-fsanitize=fuzzer OUT=/tmp/out tests/fuzz/oss-fuzz/build.sh
#
# Needs zip and the header <tl/expected.hpp> (libexpected-dev).
set -euo pipefail
: "${CXX:?}" "${CXXFLAGS:?}" "${LIB_FUZZING_ENGINE:?}" "${OUT:?}"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$OUT"
read -ra compile <<<"$CXX $CXXFLAGS -std=c++20 -I."
compile_all() { printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} sh -c '"$@" -c {} -o "$0/$(echo {} | tr / _).o"' "$work" "${compile[@]}"; }

mapfile -t sources < <(find core -name '*.cpp')
compile_all "${sources[@]}" tests/support/drive.cpp tests/fuzz/any_protocol.cpp tests/fuzz/registered.cpp tests/core/lzw_reference.cpp
ar rc "$work/core.a" "$work"/*.o

# NAME SOURCE [FLAGS]: builds one target.
target() {
  "${compile[@]}" "${@:3}" "tests/fuzz/$2" "$work/core.a" "$LIB_FUZZING_ENGINE" -o "$OUT/fuzz_$1"
  zip -jqr "$OUT/fuzz_$1_seed_corpus.zip" "tests/fuzz/corpus/$1"
}

# The rows of CMakeLists.txt are the only list.
while read -r name protocol option value; do
  target "$name" fuzz_protocol.cpp -DFUZZ_PROTOCOL="\"$protocol\"" -DFUZZ_OPTION="\"$option\"" -DFUZZ_VALUE="\"$value\""
done < <(sed -n 's/^fieldcast_fuzz_protocol(\(.*\))$/\1/p' tests/fuzz/CMakeLists.txt)
while read -r name source; do
  target "$name" "$source"
done < <(sed -nE 's/^fieldcast_fuzz\(([a-z_]+ [a-z_]+\.cpp)( [0-9]+ fieldcast_(core|lzw_reference))?\)$/\1/p' tests/fuzz/CMakeLists.txt)
