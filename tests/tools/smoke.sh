#!/usr/bin/env bash
# Smoke test of the packages of a Debian release, in a fresh root of it: they install, the plant of the demo gives values, and members with
# DDS Security exchange samples and commands.
#
#   tests/tools/smoke.sh SUITE
#
# SUITE: bookworm or trixie, whose packages `tools/package.sh --suite SUITE` has made before. Needs what tools/in_root.sh needs, and the
# network for packages of Debian.
set -euo pipefail
cd "$(dirname "$0")/../.."

suite=${1:?tests/tools/smoke.sh: name the suite, bookworm or trixie} arch=$(dpkg --print-architecture)
packages=build/packages/$suite-$arch
ls "$packages"/*.deb >/dev/null 2>&1 || { echo "tests/tools/smoke.sh: no packages; run tools/package.sh --suite $suite" >&2; exit 1; }

FIELDCAST_ROOTS=$(mktemp -d)
export FIELDCAST_ROOTS
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
trap '"${as_root[@]}" rm -rf --one-file-system "$FIELDCAST_ROOTS"' EXIT
step() { echo "=== $suite: $* (after $SECONDS s)"; }

step "the packages install"
tar -c -C "$packages" . | tools/in_root.sh "$suite" -- sh -ec 'mkdir -p packages && tar -x --no-same-owner -C packages
  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    ./packages/fieldcast_*.deb ./packages/fieldcast-sim_*.deb openssl python3-yaml >packages/log 2>&1 || { cat packages/log; exit 1; }'

step "Fast DDS calls the function that bridge/dds/library/encoding_guard.cpp replaces"
tools/in_root.sh "$suite" -- sh -ec 'for program in fieldcast fieldcast-bridge fieldcast-station; do
    LD_DEBUG=bindings LD_BIND_NOW=1 "/usr/bin/$program" --version 2>&1 | grep -q "libfast.* to /usr/bin/$program .*19encode_rtps_message" ||
      { echo "$program: the library calls its own"; exit 1; }
  done'

step "the demo"
tools/in_root.sh "$suite" -- tools/demo.sh --no-page --seconds 20 --bin /usr/bin

step "members with DDS Security"
tools/in_root.sh "$suite" -- python3 tests/tools/e2e_secure.py Secured.test_every_role_may_what_its_row_says /usr/bin
