#!/usr/bin/env bash
# Installs what is missing, builds everything with warnings as errors, runs every test.
#
#   tools/test.sh [--asan | --tsan] [ctest arguments, for instance -R Planner]
#
# --asan, --tsan: with sanitizers, in a build folder of their own. The last lines are ctest's summary; the exit code is its.
set -euo pipefail
cd "$(dirname "$0")/.."

build=build
options=(-DFIELDCAST_ASAN=OFF -DFIELDCAST_TSAN=OFF)
case "${1:-}" in
  --asan) build='build-asan'; options=(-DFIELDCAST_ASAN=ON -DFIELDCAST_TSAN=OFF); shift ;;
  --tsan) build='build-tsan'; options=(-DFIELDCAST_ASAN=OFF -DFIELDCAST_TSAN=ON); shift ;;
  -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac

tools/install.sh
log=$(mktemp)
trap 'rm -f "$log"' EXIT
generator=(-G Ninja)
[ ! -f "$build/CMakeCache.txt" ] || generator=()  # a folder that exists keeps its generator
cmake -S . -B "$build" "${generator[@]}" -DFIELDCAST_WERROR=ON -DFIELDCAST_TESTS=ON "${options[@]}" >"$log" 2>&1 ||
  { cat "$log" >&2; exit 1; }
cmake --build "$build" --parallel "$(nproc)"
ctest --test-dir "$build" --output-on-failure --no-tests=error -j2 "$@"
