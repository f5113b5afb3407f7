#!/usr/bin/env bash
# A whole plant on one machine: simulated devices on simulated serial lines, the bridge, and the station, whose page is at the address
# that is printed. Ctrl-C ends it.
#
#   tools/demo.sh [--no-page] [--seconds N] [--config FILE] [--domain N] [--bin DIR]
#
# Installs and builds what is missing. --no-page: a live table in the terminal, and no station. --seconds N: ends by itself, with exit
# code 0 only when values flowed. --config: another plant than config/examples/demo.yaml; its ports and DDS domain are replaced. --bin:
# programs that are built already. Whatever ends it, no process, link or file stays.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "tools/demo.sh: $*" >&2; exit 1; }
usage() { sed -n '2,9s/^# \{0,1\}//p' "$0"; }

page=yes seconds="" config=config/examples/demo.yaml bin=""
domain=$((60 + $$ % 40))  # not that of a bridge at work; below 101, so that its ports are none that the kernel lends out
while [ $# -gt 0 ]; do
  case "$1" in
    --no-page) page=""; shift ;;
    --seconds) seconds="${2:-}"; [[ "$seconds" =~ ^[1-9][0-9]*$ ]] || fail "--seconds needs a number, for instance 20"; shift 2 ;;
    --config) config="${2:-}"; [ -f "$config" ] || fail "no configuration '$config'"; shift 2 ;;
    --domain) domain="${2:-}"; [[ "$domain" =~ ^[0-9]+$ ]] || fail "--domain needs a number, 0 to 232"; shift 2 ;;
    --bin) bin=$(cd "${2:-}" && pwd) || fail "no folder '${2:-}'"; shift 2 ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; fail "unknown argument '$1'" ;;
  esac
done

run="" sim="" bridge="" station=""

# REQUIRES: a child of this script. Asks it to end, and insists after three seconds.
end_process() {
  [ -n "$1" ] || return 0
  kill -TERM "$1" 2>/dev/null || true
  for _ in $(seq 60); do kill -0 "$1" 2>/dev/null || break; sleep 0.05; done
  kill -KILL "$1" 2>/dev/null || true
  wait "$1" 2>/dev/null || true
}

clean_up() {
  local code=$?
  trap '' INT TERM HUP  # once is enough
  end_process "$station"
  end_process "$bridge"  # before the plant, so that it ends in order
  end_process "$sim"
  [ -z "$run" ] || rm -rf "$run"
  exit "$code"
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

if [ -z "$bin" ]; then
  tools/install.sh build
  # What a folder was configured for stays: tests that are there go on being built by tools/test.sh.
  parts=()
  [ -f build/CMakeCache.txt ] || parts=(-DFIELDCAST_TESTS=OFF -DFIELDCAST_BENCHES=OFF)
  tools/build.sh "${parts[@]}" fieldcast fieldcast-bridge fieldcast-sim ${page:+fieldcast-station} >&2 || fail "the build failed, see above"
  bin=$PWD/build/bin
fi

run=$(mktemp -d)

# The plant with its lines in the run folder, its TCP devices on this machine and a domain of its own. Lists and templates that lie
# beside the file come along.
folder=$(dirname "$config")
find "$folder" -maxdepth 1 -name '*.csv' -exec cp {} "$run" \;
[ ! -d "$folder/devices" ] || cp -r "$folder/devices" "$run"
awk -v run="$run" -v domain="$domain" '
  /^dds:/ { skipping = 1; next }
  skipping && /^[ \t#]|^$/ { next }
  { skipping = 0 }
  match($0, /serial:[ \t]*[^ \t,}]+/) {
    path = substr($0, RSTART, RLENGTH); sub(/^serial:[ \t]*/, "", path); gsub(/["\047]/, "", path); sub(/.*\//, "", path)
    $0 = substr($0, 1, RSTART - 1) "serial: " run "/" path substr($0, RSTART + RLENGTH)
  }
  match($0, /tcp:[ \t]*"?[^:" \t]+:/) {  # the simulated devices listen on this machine, whatever host the file names
    quote = substr($0, RSTART, RLENGTH) ~ /"/ ? "\"" : ""
    $0 = substr($0, 1, RSTART - 1) "tcp: " quote "127.0.0.1:" substr($0, RSTART + RLENGTH)
  }
  { print }
  END { print "dds: { domain: " domain ", interfaces: [127.0.0.1] }" }' "$config" >"$run/plant.yaml"

alive() { kill -0 "$1" 2>/dev/null; }
explain() { echo "--- $1:" >&2; tail -20 "$run/$1.log" >&2; }

# In sessions of their own: Ctrl-C in the terminal is for the table, the rest ends in order after it.
setsid "$bin/fieldcast-sim" "$run/plant.yaml" >"$run/sim.log" 2>&1 &
sim=$!
mapfile -t lines < <(grep -o "serial: $run/[^ ,}]*" "$run/plant.yaml" | cut -d' ' -f2)
for path in "${lines[@]}"; do
  for _ in $(seq 200); do [ -e "$path" ] || ! alive "$sim" || { sleep 0.05; continue; }; break; done
  [ -e "$path" ] || { explain sim; fail "the simulated line $(basename "$path") did not appear"; }
done
setsid "$bin/fieldcast-bridge" "$run/plant.yaml" >"$run/bridge.log" 2>&1 &
bridge=$!

# The page may write: who has a shell on this machine may do so anyway.
if [ -n "$page" ]; then
  cat >"$run/station.yaml" <<END
station: demo
dds: { domain: $domain, interfaces: [127.0.0.1] }
web: { local-role: operator }
store: { path: station.db }
record: { patterns: ["*"] }
END
  setsid "$bin/fieldcast-station" --config "$run/station.yaml" --listen 127.0.0.1:0 >"$run/station.log" 2>&1 &
  station=$!
  address=""
  for _ in $(seq 200); do
    address=$(grep -om1 'served at http://.*' "$run/station.log" | cut -d' ' -f3) && break
    alive "$station" || break
    sleep 0.05
  done
  [ -n "$address" ] || { explain station; fail "the station did not start"; }
  echo "The page of the plant: $address"
fi

watch=("$bin/fieldcast" watch --config "$run/plant.yaml")
code=0
trap : INT  # ends the table; then its sum, and everything in order
if [ -n "$page" ] && [ -z "$seconds" ]; then
  echo "Ctrl-C ends the demo; 'tools/demo.sh --no-page' shows a table here instead."
  trap 'exit 130' INT
  wait -n "$sim" "$bridge" "$station" || true
elif [ -z "$page" ] && { [ -t 1 ] || [ -z "$seconds" ]; }; then
  "${watch[@]}" ${seconds:+--for "${seconds}s"} 2>"$run/watch.log" || code=$?
else  # no terminal: thousands of lines help nobody, the last state does
  "${watch[@]}" --for "${seconds}s" >"$run/samples.log" 2>"$run/watch.log" || code=$?
  alive "$bridge" && [ "$code" -eq 0 ] && { "${watch[@]}" --once 2>/dev/null || true; }
fi
trap 'exit 130' INT
[ ! -f "$run/watch.log" ] || cat "$run/watch.log"
[ "$code" -ne 130 ] || exit 130
for name in sim bridge ${page:+station}; do alive "${!name}" || { explain "$name"; fail "fieldcast-$name ended by itself"; }; done
[ "$code" -eq 0 ] || { explain bridge; fail "no values flowed (fieldcast watch ended with $code)"; }
[ -z "$seconds" ] || grep -qE ' [1-9][0-9]* of them GOOD' "$run/watch.log" || { explain bridge; fail "samples came, but none was GOOD"; }
