#!/usr/bin/env bash
# Tests the packages of another processor, under qemu-user, with the programs of this machine: values, commands, the station's page, Cyclone
# DDS and DDS Security, both ways (releases_test.py). Standby is left out: its limits are those of a processor, not of an emulator.
#
#   tests/interop/dds/processor.sh ARCH [BIN_DIR [SUITE]]
#
# Like tests/tools/processor.sh, which must have run before with the same arguments: it makes the root and installs the packages there.
set -euo pipefail
cd "$(dirname "$0")/../../.."

arch=${1:?tests/interop/dds/processor.sh: name the architecture, arm64 or armhf} bin=${2:-build/bin} suite=${3:-bookworm}
roots=${FIELDCAST_ROOTS:-${XDG_CACHE_HOME:-$HOME/.cache}/fieldcast/roots} folder=/fieldcast/interop
root=$roots/$suite-$arch
[ -x "$root/usr/bin/fieldcast-bridge" ] || { echo "$0: run tests/tools/processor.sh $arch $bin $suite first"; exit 77; }
preloaded=/fieldcast/build-$arch/bin/emulated_calls.so stations=(cyclone-watch cyclone-write cyclone-results)

tools/in_root.sh "$suite" -- sh -c 'arch=$1; shift; ninja -C "build-$arch" "$@" >&2 && tar -c -C "build-$arch/bin" "$@"' sh "$arch" "${stations[@]}" |
  tools/in_root.sh "$suite" "$arch" -- sh -ec 'rm -rf "$1" && mkdir -p "$1" && tar -x --no-same-owner -C "$1"
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends cyclonedds-tools >/dev/null' sh "$folder/real"

# What releases_test.py starts: programs with the emulated calls. It recognizes Fast DDS 3 by the name of its library.
library=$(grep -aom1 'libfastdds\.so\.[0-9]*' "$root/usr/bin/fieldcast-bridge" || true)
wrap() { printf '#!/bin/sh\n# %s\nLD_PRELOAD=%s exec %s "$@"\n' "$library" "$preloaded" "$2" >"$root$folder/$1" && chmod +x "$root$folder/$1"; }
for name in fieldcast fieldcast-bridge fieldcast-sim fieldcast-station; do wrap "$name" "/usr/bin/$name"; done
for name in "${stations[@]}"; do wrap "$name" "$folder/real/$name"; done
# It names the security plug-ins of Cyclone DDS by their folder on this machine.
plugins=(/usr/lib/*/libddsc0debian) theirs=("$root"/usr/lib/*/libddsc0debian)
mkdir -p "$root$(dirname "${plugins[0]}")"
ln -sfn "${theirs[0]#"$root"}" "$root${plugins[0]}"

PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=tests/tools python3 tests/interop/dds/releases_test.py "$bin" "$root:$folder" -v \
  -k FirstBridgePlain -k FirstBridgeSecured -k SecondBridgePlain -k SecondBridgeSecured
