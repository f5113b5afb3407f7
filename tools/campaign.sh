#!/usr/bin/env bash
# Runs the fault campaign: builds its programs, runs each part for a share of the time, shows the progress and prints a report.
#
#   tools/campaign.sh --minutes N [--seed S] [--part NAME].. [--counts FILE] [--report FILE] [--files DIR] [--grown DIR]
#
# --part: see PARTS in tests/campaign/campaign.py; default: all. --counts: adds the executed cases to the counts in FILE.
# --files: directory for transcripts and failing inputs (default: a new one in /tmp). --grown: directory of the inputs that fuzzing
# found; the next run starts with them. Ctrl-C ends the campaign and prints the report so far. Exit code 1: a check failed.
# tools/test.sh runs each part for some seconds.
set -euo pipefail
cd "$(dirname "$0")/.."

parts=()
words=("$@")
for ((i = 0; i < $#; ++i)); do
  case "${words[i]}" in
    -h | --help) sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --part) parts+=("${words[i + 1]:-}") ;;
  esac
done
has() { [ "${#parts[@]}" -eq 0 ] || [[ " ${parts[*]} " == *" $1 "* ]]; }

tools/install.sh campaign
targets=()
if has virtual || has endurance; then targets+=(virtual_campaign); fi
if has system || has endurance; then targets+=(fieldcast fieldcast-bridge fieldcast-sim fault_shim store_writer); fi
if has network; then targets+=(fieldcast fieldcast-bridge fieldcast-sim cyclone-watch); fi
if [ "${#targets[@]}" -gt 0 ]; then
  tools/build.sh -DFIELDCAST_TESTS=ON "${targets[@]}"
fi
if has fuzz; then
  tools/build.sh --folder build-fuzz -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DFIELDCAST_FUZZ=ON -DFIELDCAST_PCH=OFF \
    -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF fuzz_all
  tools/build.sh --folder build-fuzz-fast -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DFIELDCAST_FUZZ=ON -DFIELDCAST_FUZZ_FAST=ON \
    -DFIELDCAST_PCH=OFF -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF fuzz_small
fi
exec python3 tests/campaign/campaign.py "$@"
