#!/usr/bin/env bash
# Runs the benches of docs/figures.md one after another and prints what they print, each under its command. Takes about 75 minutes; nothing
# else should run on the machine. On another release: tools/in_root.sh trixie -- tools/bench/figures.sh
#
#   tools/bench/figures.sh [--list] [PATTERN]
#
# PATTERN: only the commands that contain it. --list: prints the commands and runs none. Needs build/bin with tests and benches:
# tools/build.sh -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=ON. Exit code 1: one of them ended with an error, or took more than 30 minutes.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
[ -x build/bin/wire_bench ] || { echo "tools/bench/figures.sh: build/bin has no benches; see the head of this file" >&2; exit 1; }
export PATH="$PWD/build/bin:$PATH" PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=tests/tools

list=no failed=0
[ "${1:-}" != --list ] || { list=yes; shift; }
while IFS= read -r command; do
  case "$command" in *"${1:-}"*) ;; *) continue ;; esac
  [ "$list" = no ] || { echo "$command"; continue; }
  echo "=== $command"
  began=$SECONDS
  timeout --kill-after=30 1800 bash -c "$command" </dev/null 2>&1 || { echo "=== ended with $?"; failed=1; }
  echo "=== $((SECONDS - began)) s"
done <<'COMMANDS'
wire_bench
latency_bench
scale_bench --buses 16
scale_bench --buses 32
scale_bench --buses 16 --loss 0.05
scale_bench --buses 16 --run 40
scale_bench --buses 16 --scrape 5
capture_bench 3
join_bench --buses 16
join_bench --buses 64 --way blocks
join_bench --buses 64 --way cyclone-blocks
fault_bench
command_bench
command_memory_bench 1000000
python3 tests/hostile/stop_of_many.py build/bin
tools/bench/gateway_bench.py build/bin
tools/bench/gateway_bench.py build/bin --max-age 500ms
in_flight_bench --in-flight 1
in_flight_bench --in-flight 4
in_flight_bench --in-flight 8
in_flight_bench --protocol s7-tcp
in_flight_bench --protocol mitsubishi-mc
in_flight_bench --protocol omron-fins
in_flight_bench --protocol s7-tcp --connections 2 --in-flight 1
in_flight_bench --protocol s7-tcp --connections 4 --in-flight 1
in_flight_bench --protocol s7-tcp --connections 2 --in-flight 4
in_flight_bench --protocol modbus-tcp --connections 2 --in-flight 1
in_flight_bench --protocol modbus-tcp --connections 4 --in-flight 1
devices_bench
schedule_bench sustained
schedule_bench spent
schedule_bench decision
schedule_bench mixed
freeport_bench
guard_bench
dtc_bench
lzw_bench
program_bench exchange
/usr/bin/python3 tools/bench/rfc2217_bench.py build/bin
/usr/bin/python3 tools/bench/slow_path_bench.py build/bin
program_bench relay --gigabytes 10
program_bench many
store_bench --seconds 60
station_bench
station_bench --hours 8
storm_bench 1000000
endurance_bench --seconds 600
COMMANDS
exit "$failed"
