#!/usr/bin/env bash
# Runs the cells of the table in docs/platforms.md: each Debian release with demo, tests, packages and interop. Prints one line for each
# cell: release, cell, result, seconds.
#
#   tools/matrix.sh [--suite SUITE]... [CELL...]
#
# SUITE: bookworm, trixie; default: both. CELL, default: all in this order:
#   demo      the simulated plant gives values
#   tests     every test of the first stage
#   packages  they are built; in a fresh root they install, their demo gives values, and secured members exchange samples and commands
#   interop   programs of this machine (build/bin, tools/build.sh) with those of the release
# Logs are in build/matrix. Takes hours on two cores. Needs what tools/in_root.sh needs. Exit code 1: a cell failed.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1

usage() { sed -n '2,14s/^# \{0,1\}//p' "$0" >&2; exit 2; }
suites=() cells=()
while [ $# -gt 0 ]; do
  case "$1" in
    --suite) case "${2:-}" in bookworm|trixie) suites+=("$2") ;; *) usage ;; esac; shift ;;
    demo|tests|packages|interop) cells+=("$1") ;;
    *) usage ;;
  esac
  shift
done
[ "${#suites[@]}" -gt 0 ] || suites=(bookworm trixie)
[ "${#cells[@]}" -gt 0 ] || cells=(demo tests packages interop)

export FIELDCAST_ROOTS=${FIELDCAST_ROOTS:-${XDG_CACHE_HOME:-$HOME/.cache}/fieldcast/roots}
arch=$(dpkg --print-architecture)
mkdir -p build/matrix

demo() { tools/in_root.sh "$1" -- tools/demo.sh --no-page --seconds 20; }
tests() { tools/in_root.sh "$1" -- tools/test.sh; }
packages() { tools/package.sh --suite "$1" && tests/tools/smoke.sh "$1"; }
interop() {
  tools/in_root.sh "$1" -- tools/install.sh test && tools/in_root.sh "$1" -- tools/build.sh -DFIELDCAST_TESTS=ON all || return
  PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=tests/tools python3 tests/interop/dds/releases_test.py build/bin \
    "$FIELDCAST_ROOTS/$1-$arch:/fieldcast/build/bin"
}

failed=0
for suite in "${suites[@]}"; do
  for cell in "${cells[@]}"; do
    began=$SECONDS
    result=passed
    "$cell" "$suite" >"build/matrix/$suite-$cell.log" 2>&1 || { result="FAILED, see build/matrix/$suite-$cell.log"; failed=1; }
    echo "$suite $arch $cell: $result ($((SECONDS - began)) s)"
  done
done
exit "$failed"
