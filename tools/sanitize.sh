#!/usr/bin/env bash
# Runs the fuzz targets of the protocols and the compression with address and undefined-behaviour sanitizers, from the corpus with
# new mutations. Builds only these; `tools/test.sh --asan` covers everything.
#
#   tools/sanitize.sh [SECONDS]      of fuzzing for all targets together; default 60
set -euo pipefail
cd "$(dirname "$0")/.."

mapfile -t families < <(sed -n 's/^fieldcast_fuzz_protocol(\([a-z0-9_]*\) .*/\1/p' tests/fuzz/CMakeLists.txt)
families+=(gateway lzw modbus)
seconds=$((1 + ${1:-60} / ${#families[@]}))
tools/build.sh --folder build-asan -DFIELDCAST_ASAN=ON -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF \
  "${families[@]/#/fuzz_}"
printf '%s\n' "${families[@]}" |
  xargs -P "$(nproc)" -I FAMILY sh -c "build-asan/bin/fuzz_FAMILY --seconds $seconds --mutations 200 tests/fuzz/corpus/FAMILY"
