#!/usr/bin/env bash
# Runs a whole plant on one machine: simulated devices on simulated serial lines, the bridge, and the station. Prints the address of
# the station's page. Ctrl-C ends it.
#
#   tools/demo.sh [--no-page] [--seconds N] [--config FILE] [--domain N] [--bin DIR]
#
# Installs and builds missing parts. --no-page: shows a live table in the terminal, without a station. --seconds N: ends after this
# time, with exit code 0 if values were received. --config: plant instead of config/examples/demo.yaml; its ports and DDS domain are
# replaced. --bin: directory of existing programs. The demo always removes its processes, links and files.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "tools/demo.sh: $*" >&2; exit 1; }
usage() { sed -n '2,9s/^# \{0,1\}//p' "$0"; }

page=yes seconds="" config=config/examples/demo.yaml bin=""
domain=$((60 + $$ % 40))  # not a usual domain; below 101, so that its ports are not in the kernel's ephemeral range
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

# REQUIRES: a child of this script. Sends SIGTERM, and SIGKILL after three seconds.
end_process() {
  [ -n "$1" ] || return 0
  kill -TERM "$1" 2>/dev/null || true
  for _ in $(seq 60); do kill -0 "$1" 2>/dev/null || break; sleep 0.05; done
  kill -KILL "$1" 2>/dev/null || true
  wait "$1" 2>/dev/null || true
}

clean_up() {
  local code=$?
  trap '' INT TERM HUP  # run only once
  end_process "$station"
  end_process "$bridge"  # before the plant, so that it stops without errors
  end_process "$sim"
  [ -z "$run" ] || rm -rf "$run"
  exit "$code"
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

if [ -z "$bin" ]; then
  tools/install.sh build
  # Keeps the options of an existing build, so that tools/test.sh still builds its tests.
  parts=()
  [ -f build/CMakeCache.txt ] || parts=(-DFIELDCAST_TESTS=OFF -DFIELDCAST_BENCHES=OFF)
  tools/build.sh "${parts[@]}" fieldcast fieldcast-bridge fieldcast-sim ${page:+fieldcast-station} >&2 || fail "the build failed, see above"
  bin=$PWD/build/bin
fi

run=$(mktemp -d)

# Copies the configuration with its lists and templates to the run directory. Replaces serial paths, TCP hosts and the DDS domain.
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
  match($0, /tcp:[ \t]*"?[^:" \t]+:/) {  # the simulated devices listen on this machine
    quote = substr($0, RSTART, RLENGTH) ~ /"/ ? "\"" : ""
    $0 = substr($0, 1, RSTART - 1) "tcp: " quote "127.0.0.1:" substr($0, RSTART + RLENGTH)
  }
  { print }
  END { print "dds: { domain: " domain ", interfaces: [127.0.0.1] }" }' "$config" >"$run/plant.yaml"

alive() { kill -0 "$1" 2>/dev/null; }
explain() { echo "--- $1:" >&2; tail -20 "$run/$1.log" >&2; }

# In separate sessions: Ctrl-C reaches only the table; this script then stops the rest in order.
setsid "$bin/fieldcast-sim" "$run/plant.yaml" >"$run/sim.log" 2>&1 &
sim=$!
mapfile -t lines < <(grep -o "serial: $run/[^ ,}]*" "$run/plant.yaml" | cut -d' ' -f2)
for path in "${lines[@]}"; do
  for _ in $(seq 200); do [ -e "$path" ] || ! alive "$sim" || { sleep 0.05; continue; }; break; done
  [ -e "$path" ] || { explain sim; fail "the simulated line $(basename "$path") did not appear"; }
done
setsid "$bin/fieldcast-bridge" "$run/plant.yaml" >"$run/bridge.log" 2>&1 &
bridge=$!

# The page may change everything, because every user of this machine may do so by the command line and the files.
if [ -n "$page" ]; then
  cat >"$run/station.yaml" <<END
station: demo
dds: { domain: $domain, interfaces: [127.0.0.1] }
web: { local-role: engineer }
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
trap : INT  # Ctrl-C ends the table; this script continues
if [ -n "$page" ] && [ -z "$seconds" ]; then
  echo "Ctrl-C ends the demo; 'tools/demo.sh --no-page' shows a table here instead."
  trap 'exit 130' INT
  wait -n "$sim" "$bridge" "$station" || true
elif [ -z "$page" ] && { [ -t 1 ] || [ -z "$seconds" ]; }; then
  "${watch[@]}" ${seconds:+--for "${seconds}s"} 2>"$run/watch.log" || code=$?
else  # without a terminal, shows only the last state
  "${watch[@]}" --for "${seconds}s" >"$run/samples.log" 2>"$run/watch.log" || code=$?
  alive "$bridge" && [ "$code" -eq 0 ] && { "${watch[@]}" --once 2>/dev/null || true; }
fi
trap 'exit 130' INT
[ ! -f "$run/watch.log" ] || cat "$run/watch.log"
[ "$code" -ne 130 ] || exit 130
for name in sim bridge ${page:+station}; do alive "${!name}" || { explain "$name"; fail "fieldcast-$name ended by itself"; }; done
[ "$code" -eq 0 ] || { explain bridge; fail "no values flowed (fieldcast watch ended with $code)"; }
[ -z "$seconds" ] || grep -qE ' [1-9][0-9]* of them GOOD' "$run/watch.log" || { explain bridge; fail "samples came, but none was GOOD"; }
