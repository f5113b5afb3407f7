#!/usr/bin/env bash
# Installs missing packages, builds everything and runs the tests.
#
#   tools/test.sh [--asan | --tsan] [--all] [ctest arguments, for instance -R Planner]
#
# --asan, --tsan: with sanitizers, in a separate build directory. --all: also the tests of the second stage, which load the machine for
# minutes (label second-stage); ctest arguments include them too. .ci/run runs all tests. Prints ctest's summary; returns its exit code.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=build
options=(-DFIELDCAST_TESTS=ON)
case "${1:-}" in
  --asan) folder=build-asan; options+=(-DFIELDCAST_ASAN=ON); shift ;;
  --tsan) folder=build-tsan; options+=(-DFIELDCAST_TSAN=ON); shift ;;
  -h | --help) sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac

[ -f "$folder/CMakeCache.txt" ] || options+=(-DFIELDCAST_BENCHES=OFF)  # no test runs those of the whole system

stage=()
if [ "${1:-}" = --all ]; then
  shift
elif [ $# -eq 0 ]; then
  stage=(-LE second-stage)
fi

tools/install.sh test
tools/build.sh --folder "$folder" "${options[@]}"
ctest --test-dir "$folder" --output-on-failure --no-tests=error -j4 "${stage[@]}" "$@"
