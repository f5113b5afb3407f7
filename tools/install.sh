#!/usr/bin/env bash
# Installs what the build, the tests and the demo need on Debian 12. Quiet, offline and quick when nothing is missing.
# Works as root or with sudo.
set -euo pipefail

packages=(
  # the build
  build-essential g++ cmake ninja-build ccache
  # DDS and its code generator, which needs a Java that its package does not name
  libfastrtps-dev libfastcdr-dev fastddsgen openjdk-17-jre-headless
  # libraries
  libboost-dev libspdlog-dev libyaml-cpp-dev libcli11-dev libexpected-dev libsqlite3-dev libssl-dev openssl libpq-dev libsodium-dev pkg-config nlohmann-json3-dev
  # tests and benches
  libgtest-dev libgmock-dev libbenchmark-dev binutils clang-format python3
  # devices, masters and a DDS that others wrote, to test against
  libmodbus-dev python3-pymodbus python3-serial python3-serial-asyncio mbpoll socat cyclonedds-dev cyclonedds-tools
)

fail() { echo "tools/install.sh: $*" >&2; exit 1; }

command -v dpkg-query >/dev/null || fail "this is no Debian; install by hand: ${packages[*]}"

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
[ "${#missing[@]}" -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "missing: ${missing[*]} - run it as root, or install sudo"
  as_root=(sudo)
fi

echo "tools/install.sh: installing ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt_get() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -qq -o Dpkg::Use-Pty=0 "$@" >"$log" 2>&1 ||
    { cat "$log" >&2; fail "'apt-get $*' failed, see above"; }
}
apt_get update
apt_get install --no-install-recommends "${missing[@]}"
