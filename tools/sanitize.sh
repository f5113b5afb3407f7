#!/usr/bin/env bash
# Runs the fuzz targets of the protocols and the compression with address and undefined-behaviour sanitizers, from the corpus with
# new mutations. Builds only these; `tools/test.sh --asan` covers everything.
#
#   tools/sanitize.sh [SECONDS]      of fuzzing for all targets together; default 60
set -euo pipefail
cd "$(dirname "$0")/.."

families=(dtc lzw mitsubishi_fx mitsubishi_mc mitsubishi_mc_ascii modbus omron_fins omron_hostlink s7_freeport s7_ppi)
seconds=$((1 + ${1:-60} / ${#families[@]}))
tools/build.sh --folder build-asan -DFIELDCAST_ASAN=ON -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF \
  "${families[@]/#/fuzz_}"
printf '%s\n' "${families[@]}" |
  xargs -P "$(nproc)" -I FAMILY sh -c "build-asan/bin/fuzz_FAMILY --seconds $seconds --mutations 200 tests/fuzz/corpus/FAMILY"
