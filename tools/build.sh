#!/usr/bin/env bash
# Configures and builds with one set of flags, so that the demo, the tests and CI share their objects. Shows the progress.
#
#   tools/build.sh [--folder DIR] [-DNAME=VALUE ..] [TARGET ..]
#
# --folder: default `build`. Without targets, builds everything. Packages must be installed (tools/install.sh).
set -euo pipefail
cd "$(dirname "$0")/.."

folder=build options=(-DFIELDCAST_UNITY=ON) targets=()
while [ $# -gt 0 ]; do
  case "$1" in
    --folder) folder=$2; shift ;;
    -D*) options+=("$1") ;;
    *) targets+=("$1") ;;
  esac
  shift
done
[ "${#targets[@]}" -gt 0 ] || targets=(all)

if [ ! -f "$folder/CMakeCache.txt" ]; then  # an existing directory keeps its generator
  options+=(-G Ninja)
  echo "configuring $folder" >&2
fi
if ! log=$(cmake -S . -B "$folder" "${options[@]}" 2>&1); then
  echo "$log" >&2
  exit 1
fi

cores=$(nproc)
if [ -f "$folder/build.ninja" ]; then
  steps=$(ninja -C "$folder" -n "${targets[@]}" | sed -n 's/^\[[0-9]*\/\([0-9]*\)\].*/\1/p' | tail -1)
  if [ "${steps:-0}" -gt 10 ]; then
    seconds_of_step=2  # average processor time
    echo "building $folder: $steps steps on $cores cores, $((1 + steps * seconds_of_step / cores / 60)) minutes or so;" \
         "less where ccache knows them" >&2
  fi
fi
NINJA_STATUS='[%f/%t, %es] ' cmake --build "$folder" --parallel "$cores" --target "${targets[@]}"
