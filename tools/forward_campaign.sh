#!/usr/bin/env bash
# Runs the fault campaign of fieldcast-forward: builds its programs, injects faults while samples flow from many simulated sites to a
# cluster of JetStream, and prints a report of what arrived.
#
#   tools/forward_campaign.sh [--minutes M] [--sites N] [--channels C] [--seed S] [--nodes 3] [--folder DIR] [--stores] [--backfill] [--bin DIR]
#
# Default: 10 minutes, 5 sites of 200 channels, seed 1. --folder: keeps logs, queues and records there. --stores: each bridge has a
# store, which is compared with what arrived. --backfill: also, samples that were published while a forwarder did not run must arrive.
# --bin: directory of existing programs. As root, it uses namespaces of its own and can lose packets. Exit code 1: a sample is missing,
# out of order or wrong. tests/tools/forward_campaign.py describes the rules.
set -euo pipefail
cd "$(dirname "$0")/.."

bin="" words=()
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,11s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --bin) bin=${2:?--bin needs a directory}; shift 2 ;;
    *) words+=("$1"); shift ;;
  esac
done
if [ -z "$bin" ]; then
  tools/install.sh test
  tools/build.sh -DFIELDCAST_BENCHES=ON fieldcast-forward bench_bridge >&2
  bin=build/bin
fi
server=$(PATH=$PATH:/usr/sbin command -v nats-server || echo build/unpacked/nats-server/usr/sbin/nats-server)
exec /usr/bin/python3 tests/tools/forward_campaign.py --bin "$bin" --nats "$server" --minutes 10 --sites 5 --channels 200 "${words[@]}"
