#!/usr/bin/env bash
# Tests the programs of another processor under qemu-user, in a root of that processor: the packages install, the unit tests of core and
# config pass, the demo's plant gives values, and 24 golden captures are explained as by the programs of this machine, byte for byte.
#
#   tests/tools/processor.sh ARCH [BIN_DIR [SUITE]]
#
# ARCH: arm64 or armhf, whose packages `tools/package.sh --arch ARCH --suite SUITE` has made before. BIN_DIR: programs of this machine, default
# build/bin. SUITE: bookworm (default) or trixie.
# Needs what tools/in_root.sh needs, and the network for packages of Debian. Ends with 77 if this machine lacks something.
set -euo pipefail
cd "$(dirname "$0")/../.."

arch=${1:?tests/tools/processor.sh: name the architecture, arm64 or armhf} bin=${2:-build/bin} suite=${3:-bookworm}
[ "$(id -u)" -eq 0 ] || { echo "tests/tools/processor.sh: not root"; exit 77; }
for program in mmdebstrap rsync qemu-aarch64-static; do
  command -v "$program" >/dev/null || { echo "tests/tools/processor.sh: $program is missing"; exit 77; }
done

packages=build/packages/$suite-$arch
ls "$packages"/*.deb >/dev/null 2>&1 || { echo "tests/tools/processor.sh: no packages; run tools/package.sh --arch $arch --suite $suite"; exit 77; }

# None of these opens a port or uses DDS.
tests=(core_test lzw_test protocol_test declared_test plan_test dispatch_test bus_test transcript_test config_test)
here() { tools/in_root.sh "$suite" -- "$@"; }
there() { tools/in_root.sh "$suite" "$arch" -- "$@"; }
step() { echo "=== $* (after $SECONDS s)"; }

step "unit tests for $arch"
here sh -ec 'arch=$1; shift
  tools/build.sh --folder "build-$arch" -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=OFF "$@" >&2
  setting() { sed -n "s/^$1:[A-Z]*=//p" "build-$arch/CMakeCache.txt"; }
  mkdir -p "build-$arch/stripped"
  for name; do "$(setting CMAKE_STRIP)" -o "build-$arch/stripped/$name" "build-$arch/bin/$name"; done
  compiler=$(setting CMAKE_STRIP | sed "s/strip\$/gcc/")
  "$compiler" -O1 -shared -fPIC -Wall -Wextra -o "build-$arch/stripped/emulated_calls.so" tests/tools/emulated_calls.c' sh "$arch" "${tests[@]}"

step "the root for $arch"
# The tests find the tree from their build folder, and the shipped declarations beside the folder of the program.
here tar -c -C "build-$arch/stripped" . | there sh -ec 'mkdir -p "$1/bin" "$1/share" && tar -x --no-same-owner -C "$1/bin"
  ln -sfn /fieldcast/config "$1/share/fieldcast"' sh "build-$arch"
tar -c -C "$packages" . | there sh -ec 'mkdir -p packages && tar -x --no-same-owner -C packages
  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    ./packages/fieldcast_*.deb ./packages/fieldcast-sim_*.deb >packages/log 2>&1 || { cat packages/log; exit 1; }'
there sh -c 'for program in fieldcast fieldcast-bridge fieldcast-port fieldcast-station fieldcast-sim; do "$program" --version || exit 1; done'

failed=0
for name in "${tests[@]}"; do
  step "$name under qemu"
  there "build-$arch/bin/$name" --gtest_brief=1 || failed=1
done

step "the demo's plant under qemu"
unshare --net --ipc sh -c 'ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh \
  tools/in_root.sh "$suite" "$arch" -- env LD_PRELOAD="/fieldcast/build-$arch/bin/emulated_calls.so" \
  tools/demo.sh --no-page --seconds 40 --bin /usr/bin || failed=1

step "24 golden captures"
rm -rf build/golden
python3 tests/tools/golden_captures.py "$bin" . build/golden
sh build/golden/show.sh "$(realpath "$bin")" "$PWD/build/golden/here"
tar -c -C build golden | there sh -c 'rm -rf golden && tar -x --no-same-owner && rm -rf golden/here'
there sh -c 'sh golden/show.sh /usr/bin /fieldcast/golden/there >&2 && tar -c -C golden there' | tar -x --no-same-owner -C build/golden
[ "$(ls build/golden/here | wc -l)" -eq 24 ]
diff -r build/golden/here build/golden/there && echo "24 of 24 agree byte for byte, $(cat build/golden/here/* | wc -c) bytes" || failed=1
exit "$failed"
