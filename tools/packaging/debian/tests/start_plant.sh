# Sourced by the tests: runs the simulated plant of the package's demo in a temporary folder until the test ends.
# Afterwards $domain is its DDS domain and $plant its configuration.
set -eu
folder=$(mktemp -d "${AUTOPKGTEST_TMP:-/tmp}/plant.XXXXXX")
domain=$((60 + $$ % 40))
plant=$folder/plant.yaml
sim="" bridge=""
stop_plant() {
  for process in $bridge $sim; do kill "$process" 2>/dev/null && wait "$process" || true; done
  rm -rf "$folder"
}
trap stop_plant EXIT

cp /usr/share/fieldcast/examples/*.csv "$folder"
sed -e "s,/tmp/fieldcast-demo,$folder," -e '/^dds:/d' /usr/share/fieldcast/examples/demo.yaml >"$plant"
echo "dds: { domain: $domain, interfaces: [127.0.0.1] }" >>"$plant"
fieldcast-bridge --check "$plant"
fieldcast-sim "$plant" >"$folder/sim.log" 2>&1 &
sim=$!
fieldcast-bridge "$plant" >"$folder/bridge.log" 2>&1 &
bridge=$!

# Prints the values of a pattern as JSON lines, when there are good ones; fails after 30 s.
good_values() {
  for _ in $(seq 30); do
    if fieldcast watch "$1" --once --for 1s --json --config "$plant" 2>/dev/null | grep '"GOOD"'; then return; fi
    sleep 0.5
  done
  echo "no good value of $1" >&2
  cat "$folder/sim.log" "$folder/bridge.log" >&2
  return 1
}
