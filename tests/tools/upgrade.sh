#!/usr/bin/env bash
# Tests that an upgrade of the packages, and the downgrade after it, keep configurations and stores. Changes the Debian in which it
# runs as root, therefore only for a root of its own:
#
#   tools/in_root.sh bookworm -- tests/tools/upgrade.sh OLD NEW
#
# OLD and NEW are folders with the packages of two versions. No systemd runs in such a root: this script runs the programs as the user
# fieldcast. EndToEnd.Install tests that the services restart.
set -euo pipefail
old=$1 new=$2
fail() { echo "tests/tools/upgrade.sh: $*" >&2; exit 1; }
[ -f /etc/fieldcast-root ] || fail "this is not a root of tools/in_root.sh"

config=/etc/fieldcast/plant.yaml store=/var/lib/fieldcast/plant.db
install_from() {
  apt-get install -y -qq --no-install-recommends --allow-downgrades "$1"/fieldcast_*.deb "$1"/fieldcast-sim_*.deb >/tmp/apt.log 2>&1 ||
    { cat /tmp/apt.log >&2; fail "the packages of $1 cannot be installed"; }
  echo "installed: $(fieldcast --version), package $(dpkg-query -W -f '${Version}' fieldcast)"
}
as_service=(setpriv --reuid=fieldcast --regid=fieldcast --init-groups)
history() { [ ! -f "$store" ] || "${as_service[@]}" fieldcast history line/meter/power --store "$store" --json 2>/dev/null || true; }
kept() { sha256sum "$config" /etc/systemd/system/fieldcast-bridge@plant.service.d/limits.conf; stat -c '%U %G %a %n' "$config" "$store"; }

# Runs plant and bridge until the store has more samples than before; they stop in order.
run_for_samples() {
  local before sim bridge code=0
  before=$(history | wc -l)
  "${as_service[@]}" fieldcast-sim "$config" >/tmp/sim.log 2>&1 & sim=$!
  "${as_service[@]}" fieldcast-bridge "$config" >/tmp/bridge.log 2>&1 & bridge=$!
  for _ in $(seq 60); do
    [ "$(history | wc -l)" -le "$((before + 5))" ] || break
    sleep 0.5
  done
  kill "$bridge"
  wait "$bridge" || code=$?
  kill "$sim"
  wait "$sim" || true
  [ "$code" = 0 ] || { cat /tmp/bridge.log >&2; fail "the bridge ended with exit code $code"; }
  [ "$(history | wc -l)" -gt "$before" ] || { cat /tmp/bridge.log >&2; fail "the store received no sample"; }
}

# Installs the packages of a folder and compares what must stay.
change_to() {
  local files samples
  files=$(kept)
  samples=$(history | sort)
  install_from "$1"
  [ "$(kept)" = "$files" ] || fail "changed: $(diff <(echo "$files") <(kept))"
  fieldcast-bridge --check "$config" >/dev/null
  [ -z "$(comm -23 <(echo "$samples") <(history | sort))" ] || fail "samples of the store are missing after the change to $1"
  run_for_samples
  [ -z "$(comm -23 <(echo "$samples") <(history | sort))" ] || fail "the version of $1 removed samples"
  echo "kept: configuration, unit settings, and $(wc -l <<<"$samples") samples; then $(history | wc -l)"
}

rm -rf /etc/fieldcast /var/lib/fieldcast  # of an earlier run
install_from "$old"
mkdir -p /etc/systemd/system/fieldcast-bridge@plant.service.d
echo "[Service]
MemoryMax=64M" >/etc/systemd/system/fieldcast-bridge@plant.service.d/limits.conf
cat >"$config" <<END
# edited by the administrator
bridge: plant
dds: { domain: 73, interfaces: [127.0.0.1] }
store: { path: $store, keep: 90d }
buses:
  - name: line
    port: { serial: /var/lib/fieldcast/line, baud: 19200 }
    protocol: modbus-rtu
    devices:
      - name: meter
        address: 1
        channels:
          - { name: power, at: "holding:0", type: float32, unit: W, refresh: 500ms }
END
chown root:fieldcast "$config"
chmod 640 "$config"
run_for_samples
change_to "$new"
change_to "$old"
change_to "$new"
apt-get purge -y -qq fieldcast fieldcast-sim >/dev/null 2>&1
[ -s "$config" ] && [ -s "$store" ] || fail "the purge removed files of the user"
echo "kept after the purge: $config and $store"
