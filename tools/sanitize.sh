#!/usr/bin/env bash
# Runs a part of the tests with sanitizers and builds only this part; `tools/test.sh --asan` and `--tsan` run all tests.
#
#   tools/sanitize.sh [SECONDS]
#   tools/sanitize.sh --integration thread | address [ctest arguments, for instance -R DdsLink]
#
# Without an option: the fuzz targets of the protocols and the compression with address and undefined-behaviour sanitizers, from the
# corpus with new mutations, SECONDS (default 60) for all targets together.
# --integration: the test programs with DDS or threads, with the thread sanitizer, or with the address and undefined-behaviour
# sanitizers. Prints each report of a sanitizer, also of a program that a test started. Returns 1 if there is one or a test failed.
set -euo pipefail
cd "$(dirname "$0")/.."

integration() {
  local kind=${1:-} folder option failed=0 report reports=0
  case "$kind" in
    thread) folder=build-tsan option=FIELDCAST_TSAN ;;
    address) folder=build-asan option=FIELDCAST_ASAN ;;
    *) sed -n '2,11s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
  esac
  shift
  tools/install.sh test
  tools/build.sh --folder "$folder" "-D$option=ON" -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF integration_tests
  rm -f "$folder"/reports/*
  ctest --test-dir "$folder" --output-on-failure --no-tests=error -j "$(nproc)" -L '^(dds|threads)$' "$@" || failed=1
  for report in "$folder"/reports/*; do
    [ -s "$report" ] || continue
    cat "$report"
    reports=$((reports + 1))
  done
  echo "tools/sanitize.sh: $reports processes with reports of the $kind sanitizer"
  [ "$reports" -eq 0 ] && return "$failed"
  return 1
}

if [ "${1:-}" = --integration ]; then
  shift
  integration "$@"
  exit
fi

mapfile -t families < <(sed -n 's/^fieldcast_fuzz_protocol(\([a-z0-9_]*\) .*/\1/p' tests/fuzz/CMakeLists.txt)
families+=(gateway lzw modbus)
seconds=$((1 + ${1:-60} / ${#families[@]}))
tools/build.sh --folder build-asan -DFIELDCAST_ASAN=ON -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF \
  "${families[@]/#/fuzz_}"
printf '%s\n' "${families[@]}" |
  xargs -P "$(nproc)" -I FAMILY sh -c "build-asan/bin/fuzz_FAMILY --seconds $seconds --mutations 200 tests/fuzz/corpus/FAMILY"
