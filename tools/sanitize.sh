#!/usr/bin/env bash
# What reads bytes from outside, with address and undefined-behaviour sanitizers: the tests of all protocols, and their fuzz targets
# from the corpus with new mutations. Some two minutes of processor; `tools/test.sh --asan` does it for everything.
#
#   tools/sanitize.sh [SECONDS]      of fuzzing, for all targets together; 60
set -euo pipefail
cd "$(dirname "$0")/.."

families=(dtc lzw mitsubishi_fx modbus omron_fins omron_hostlink s7_freeport s7_ppi)
seconds=$((1 + ${1:-60} / ${#families[@]}))
tools/build.sh --folder build-asan -DFIELDCAST_ASAN=ON -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF \
  protocol_test "${families[@]/#/fuzz_}"
build-asan/bin/protocol_test --gtest_brief=1
printf '%s\n' "${families[@]}" |
  xargs -P "$(nproc)" -I FAMILY build-asan/bin/fuzz_FAMILY --seconds "$seconds" --mutations 200 tests/fuzz/corpus/FAMILY
