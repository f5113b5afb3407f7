#!/usr/bin/env bash
# Installs missing packages of Debian 12 or 13 and shows the progress. Prints nothing and works offline if nothing is missing.
#
#   tools/install.sh [build | package | image | test | campaign | coverage | ci | reference | windows]
#   tools/install.sh cross ARCH
#
# build: for the programs and the demo. package: also for tools/package.sh. image: for tools/image.sh. test (default): also for the
# tests. campaign: also for tools/campaign.sh. coverage: also for tools/coverage.sh and tools/mutate.sh. ci: for the tests and the
# checkers of .ci/run. reference: Doxygen for tools/reference.sh. windows: for tools/windows.sh and its tests. Works as root or with
# sudo. Packages that would start a server are not installed for tests, except PostgreSQL and mosquitto: test and ci unpack the programs
# they need from them to build/unpacked/PACKAGE.
# cross: for tools/package.sh --arch ARCH, with the libraries of ARCH (arm64 or armhf); only in a root of tools/in_root.sh, because the
# libraries of ARCH replace those of this machine.
set -euo pipefail
cd "$(dirname "$0")/.."

# Packages that have other names in one release, VERSION_ID by VERSION_ID: what for, Debian 12, Debian 13.
release=$(sed -n 's/^VERSION_ID="\{0,1\}\([0-9]*\).*/\1/p' /etc/os-release 2>/dev/null || true)
named() {
  local column=2
  [ "${release:-12}" -lt 13 ] || column=3
  awk -v name="$1" -v column="$column" '$1 == name { print $column }' <<'TABLE'
dds libfastrtps-dev libfastdds-dev
TABLE
}

tools=(
  g++ cmake ninja-build ccache mold pkg-config
  # the code generator of DDS, whose package does not depend on the Java that it needs
  fastddsgen default-jre-headless
  protobuf-compiler
)
# Packages with files for one architecture, and packages for all.
libraries=(
  "$(named dds)" libfastcdr-dev
  libboost-dev libfmt-dev libspdlog-dev libyaml-dev libsqlite3-dev libssl-dev libpq-dev libsodium-dev libtinyxml2-dev zlib1g-dev
  libtomlplusplus-dev libzip-dev libxlsxwriter-dev libmuparser-dev
  libmosquitto-dev libnats-dev librdkafka-dev libcurl4-openssl-dev libsnappy-dev libprotobuf-dev libzstd-dev
  libncurses-dev
)
headers=(libcli11-dev libexpected-dev nlohmann-json3-dev)
build=("${tools[@]}" "${libraries[@]}" "${headers[@]}")
packaging=(dpkg-dev file)
image=(mmdebstrap python3 dpkg-dev)
test=(
  "${packaging[@]}"
  libgtest-dev libgmock-dev binutils clang-format python3 openssl curl sqlite3
  # a separate root with systemd, to test the packages
  systemd util-linux iproute2
  # manual pages, and the signed repository of packages
  man-db gpg gpg-agent
  # third-party devices, masters and DDS, for interoperability tests
  libmodbus-dev python3-yaml python3-pymodbus python3-nmea2 python3-serial python3-serial-asyncio ser2net mbpoll socat cyclonedds-dev cyclonedds-tools
  # reads captures as Wireshark does
  tshark
  # the tests start their own servers
  postgresql mosquitto mosquitto-clients
  # discovery servers, firewalls and tunnels
  fastdds-tools nftables openvpn
  # a mail server with TLS and logins
  python3-aiosmtpd
  # a consumer of Kafka
  kcat
  # a browser, for the station's page, and a terminal, for the screens
  chromium python3-pyte
)
campaign=(
  # libFuzzer
  clang libclang-rt-dev
)
coverage=(
  # the first clang that measures MC/DC is 18; the second line is for tools/mutate.sh
  clang-19 llvm-19 libclang-rt-19-dev
  python3-clang
)
# runc and umoci run the container image in a test, rsync is for tools/in_root.sh
ci=(clang-tidy codespell git lintian python3-prometheus-client doxygen "${image[@]}" runc umoci rsync)

# The compiler of mingw-w64 with POSIX threads, make and perl for OpenSSL, the maker of the installer, and wine for the tests.
windows=(cmake ninja-build ccache g++-mingw-w64-x86-64-posix make perl libboost-dev libfmt-dev libcli11-dev libexpected-dev nsis wine64 python3
         python3-serial openssl)

fail() { echo "tools/install.sh: $*" >&2; exit 1; }

case "${1:-test}" in
  build) packages=("${build[@]}") ;;
  package) packages=("${build[@]}" "${packaging[@]}") ;;
  image) packages=("${image[@]}") ;;
  test) packages=("${build[@]}" "${test[@]}") ;;
  campaign) packages=("${build[@]}" "${test[@]}" "${campaign[@]}") ;;
  coverage) packages=("${build[@]}" "${test[@]}" "${coverage[@]}") ;;
  ci) packages=("${build[@]}" "${test[@]}" "${ci[@]}") ;;
  reference) packages=(doxygen) ;;
  windows) packages=("${windows[@]}") ;;
  cross)
    arch=${2:?tools/install.sh: cross needs an architecture}
    [ -f /etc/fieldcast-root ] || fail "cross changes the libraries of a whole system; run it by tools/in_root.sh"
    # The last five are for the unit tests of that architecture.
    packages=("${tools[@]}" "${headers[@]}" "${packaging[@]}" "crossbuild-essential-$arch"
              "${libraries[@]/%/:$arch}" "libgtest-dev:$arch" "libgmock-dev:$arch" "libmodbus-dev:$arch" "cyclonedds-dev:$arch" cyclonedds-tools) ;;
  *) sed -n '2,13s/^# \{0,1\}//p' "$0" >&2; exit 1 ;;
esac

command -v dpkg-query >/dev/null || fail "this is no Debian; install by hand: ${packages[*]}"

# NAME is that of this machine: the package of another architecture (cross) is not enough.
here=$(dpkg --print-architecture)
installed() {
  local wanted=$here
  [[ "$1" != *:* ]] || wanted=${1#*:}
  dpkg-query -W -f '${Architecture} ${db:Status-Status}\n' "$1" 2>/dev/null | grep -qxE "(all|$wanted) installed"
}
missing=()
for package in "${packages[@]}"; do installed "$package" || missing+=("$package"); done
# SETS PACKAGE PROGRAM PATH: unpacks PATH of the package if the program is not installed.
unpacked=()
while read -r sets package program path; do
  [[ "${1:-test}" =~ ^($sets)$ ]] || continue
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || [ -d "build/unpacked/$package" ] || unpacked+=("$package $path")
done <<'TABLE'
test|campaign|ci nats-server nats-server ./usr/sbin/nats-server
ci prometheus promtool ./usr/bin
ci influxdb influxd ./usr/bin/influxd
ci victoria-metrics victoria-metrics ./usr/bin/victoria-metrics
ci udev udevadm .
TABLE
# Checks the command instead of the package, because Debian's npm conflicts with a node from another source.
[[ "${1:-test}" =~ ^(image|windows)$ ]] || command -v npm >/dev/null || missing+=(nodejs npm)
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

# Shows apt's status lines (dlstatus:.. for downloads, pmstatus:.. for the installation) as per cent: in one line of a terminal,
# else one line for each tenth. Other lines go to the log.
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

# Status lines use descriptor 3, because apt closes the status descriptor in its children: with descriptor 1, package scripts that
# print would fail. sudo closes descriptors above 2, so the inner shell opens it.
apt_get() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive sh -c 'exec apt-get "$@" 3>&1' \
    apt-get -y -qq -o Dpkg::Use-Pty=0 -o APT::Status-Fd=3 "$@" 2>&1 |
    show_progress || { cat "$log" >&2; fail "'apt-get $*' failed, see above"; }
}

[ "${1:-test}" != cross ] || dpkg --add-architecture "$arch"
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
# Prints apt's two lines about the download and disk size; changes nothing.
"${as_root[@]}" env LC_ALL=C apt-get --assume-no --no-install-recommends install "${missing[@]}" 2>/dev/null |
  sed -n -E 's/^(Need to get|After this operation)/  \1/p' >&2 || true
echo "  one to three minutes, as fast as the network and the disk are" >&2
apt_get install --no-install-recommends "${missing[@]}"
