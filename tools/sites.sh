#!/usr/bin/env bash
# Runs N simulated sites on this machine, each with a DDS domain and a forwarder of its own, and a JetStream server. Prints their
# addresses and, every ten seconds, the state of the stream. Ctrl-C ends all of it and removes its files.
#
#   tools/sites.sh N [--channels 100] [--nodes 1] [--round-trip MS] [--seconds S] [--bin DIR]
#
# Each channel has a new value once a second. --nodes 3: a cluster that stores each message three times. --seconds: ends after this time,
# with exit code 0 if samples of every site are in the stream. --bin: directory of existing programs; missing ones are built otherwise.
set -euo pipefail
cd "$(dirname "$0")/.."

bin="" words=()
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --bin) bin=${2:?--bin needs a directory}; shift 2 ;;
    *) words+=("$1"); shift ;;
  esac
done
if [ -z "$bin" ]; then
  tools/install.sh test
  tools/build.sh -DFIELDCAST_BENCHES=ON fieldcast fieldcast-forward bench_bridge >&2
  bin=build/bin
fi
server=$(PATH=$PATH:/usr/sbin command -v nats-server || echo build/unpacked/nats-server/usr/sbin/nats-server)
exec /usr/bin/python3 tests/tools/run_sites.py --bin "$bin" --nats "$server" "${words[@]}"
