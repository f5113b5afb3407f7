#!/usr/bin/env bash
# Installs missing packages, builds everything and runs every test.
#
#   tools/test.sh [--asan | --tsan] [ctest arguments, for instance -R Planner]
#
# --asan, --tsan: with sanitizers, in a separate build directory. The last lines and the exit code are those of ctest.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=build
options=(-DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=ON)
case "${1:-}" in
  --asan) folder=build-asan; options+=(-DFIELDCAST_ASAN=ON); shift ;;
  --tsan) folder=build-tsan; options+=(-DFIELDCAST_TSAN=ON); shift ;;
  -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac

tools/install.sh test
tools/build.sh --folder "$folder" "${options[@]}"
ctest --test-dir "$folder" --output-on-failure --no-tests=error -j2 "$@"
