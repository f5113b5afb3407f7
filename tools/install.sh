#!/usr/bin/env bash
# Installs Debian 12's packages that are missing, and shows how far it is. Quiet, offline and quick when nothing is missing.
#
#   tools/install.sh [build | package | test | campaign | ci | reference]
#
# build: what the programs and the demo need. package: that, and what tools/package.sh needs. test (where nothing is said): that,
# and what the tests need. campaign: that, and what tools/campaign.sh needs. ci: what the tests need, and the checkers of .ci/run.
# reference: doxygen, for tools/reference.sh.
# Works as root or with sudo. Of packages with a server that nobody wants to run here, ci unpacks only the programs that check
# something, to build/unpacked/PACKAGE.
set -euo pipefail
cd "$(dirname "$0")/.."

build=(
  g++ cmake ninja-build ccache mold pkg-config
  # DDS and its code generator, which needs a Java that its package does not name
  libfastrtps-dev libfastcdr-dev fastddsgen openjdk-17-jre-headless
  libboost-dev libfmt-dev libspdlog-dev libyaml-cpp-dev libcli11-dev libexpected-dev libsqlite3-dev libssl-dev libpq-dev libsodium-dev libtinyxml2-dev zlib1g-dev
  nlohmann-json3-dev libtomlplusplus-dev libzip-dev
  libncurses-dev
)
packaging=(dpkg-dev file)
test=(
  "${packaging[@]}"
  libgtest-dev libgmock-dev binutils clang-format python3 openssl curl sqlite3
  # a root of its own, with systemd, for the packages
  systemd util-linux iproute2
  # devices, masters and a DDS that others wrote, to test against
  libmodbus-dev python3-pymodbus python3-serial python3-serial-asyncio mbpoll socat cyclonedds-dev cyclonedds-tools
  # what Wireshark makes of captures
  tshark
  # the tests start servers of their own
  postgresql
  # discovery servers, firewalls and tunnels
  fastdds-tools nftables openvpn
  # a browser, for the station's page, and a terminal, for the screens
  chromium python3-pyte
)
campaign=(
  # libFuzzer
  clang libclang-rt-14-dev
)
ci=(clang-tidy codespell git lintian python3-prometheus-client doxygen)

fail() { echo "tools/install.sh: $*" >&2; exit 1; }

case "${1:-test}" in
  build) packages=("${build[@]}") ;;
  package) packages=("${build[@]}" "${packaging[@]}") ;;
  test) packages=("${build[@]}" "${test[@]}") ;;
  campaign) packages=("${build[@]}" "${test[@]}" "${campaign[@]}") ;;
  ci) packages=("${build[@]}" "${test[@]}" "${ci[@]}") ;;
  reference) packages=(doxygen) ;;
  *) sed -n '2,10s/^# \{0,1\}//p' "$0" >&2; exit 1 ;;
esac

command -v dpkg-query >/dev/null || fail "this is no Debian; install by hand: ${packages[*]}"

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
# PACKAGE PROGRAM PATH: what of a package is unpacked where the program is not installed.
unpacked=()
if [ "${1:-test}" = ci ]; then
  while read -r package program path; do
    command -v "$program" >/dev/null || [ -d "build/unpacked/$package" ] || unpacked+=("$package $path")
  done <<'TABLE'
prometheus promtool ./usr/bin/promtool
udev udevadm .
TABLE
fi
# A machine may bring a node of its own, which Debian's npm conflicts with: asked for is the command, not the package.
command -v npm >/dev/null || missing+=(nodejs npm)
[ $((${#missing[@]} + ${#unpacked[@]})) -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "missing: ${missing[*]} - run it as root, or install sudo"
  as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
terminal=no
[ ! -t 2 ] || terminal=yes

# apt's status lines (dlstatus:.. while it loads, pmstatus:.. while it installs) as per cent: in one line of a terminal, else one
# line for each tenth. Everything else goes to the log.
show_progress() {
  awk -F: -v log_file="$log" -v terminal="$terminal" '
    $1 != "dlstatus" && $1 != "pmstatus" { print >log_file; next }
    { phase = $1 == "dlstatus" ? "load" : "install"
      tenth = phase int($3 / 10)
      if (terminal == "yes") printf "\r\033[K  %s %3d %%  %s", phase, $3, substr($4, 1, 50) >"/dev/stderr"
      else if (tenth != told) printf "  %s %d %%\n", phase, $3 >"/dev/stderr"
      told = tenth }
    END { if (terminal == "yes" && told != "") printf "\r\033[K" >"/dev/stderr" }'
}

# The status lines have a descriptor of their own: apt closes it for what it starts, and packages that say something while they are
# set up would fail. sudo closes what is above 2, so it is opened behind it.
apt_get() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive sh -c 'exec apt-get "$@" 3>&1' \
    apt-get -y -qq -o Dpkg::Use-Pty=0 -o APT::Status-Fd=3 "$@" 2>&1 |
    show_progress || { cat "$log" >&2; fail "'apt-get $*' failed, see above"; }
}

apt_get update
for row in "${unpacked[@]}"; do
  read -r package path <<<"$row"
  echo "tools/install.sh: unpacking $package" >&2
  download=$(mktemp -d)
  (cd "$download" && apt-get download -qq "$package" 2>>"$log") || { cat "$log" >&2; fail "$package cannot be downloaded"; }
  mkdir -p "build/unpacked/$package"
  dpkg-deb --fsys-tarfile "$download"/*.deb | tar -x -C "build/unpacked/$package" "$path"
  rm -r "$download"
done
[ "${#missing[@]}" -gt 0 ] || exit 0

echo "tools/install.sh: installing ${missing[*]}" >&2
# Two lines of apt say how much it is; it changes nothing here.
"${as_root[@]}" env LC_ALL=C apt-get --assume-no --no-install-recommends install "${missing[@]}" 2>/dev/null |
  sed -n -E 's/^(Need to get|After this operation)/  \1/p' >&2 || true
echo "  one to three minutes, as fast as the network and the disk are" >&2
apt_get install --no-install-recommends "${missing[@]}"
