#!/usr/bin/env bash
# Gets and builds mqmgateway, the peer of peers_bench.py, in a folder outside of the source tree.
#
# usage: tools/bench/peers/get.sh FOLDER
#
# Debian packages: see PACKAGES. It prints what is missing and ends with 77 if the peer cannot be had here.
# MQMGATEWAY_GIT: another address of the repository, for example a local copy.
set -eu

PACKAGES="git cmake g++ mosquitto mosquitto-clients libmosquitto-dev libmodbus-dev libyaml-cpp-dev libspdlog-dev libfmt-dev rapidjson-dev"
ADDRESS=${MQMGATEWAY_GIT:-https://github.com/BlackZork/mqmgateway}
COMMIT=2510deff094e8e4f4c07f49f021842a9c5e49232 # version 4.0.0

skip() {
  echo "skipped: $1" >&2
  exit 77
}

[ $# -eq 1 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 2; }
folder=$1
mkdir -p "$folder"
# shellcheck disable=SC2086
missing=$(for package in $PACKAGES; do dpkg -s "$package" >/dev/null 2>&1 || echo "$package"; done)
[ -z "$missing" ] || skip "apt-get install $(echo $missing)"

source=$folder/mqmgateway
if [ ! -d "$source" ]; then
  git clone -q "$ADDRESS" "$source" || skip "cannot clone $ADDRESS"
fi
git -C "$source" checkout -q "$COMMIT" || skip "$ADDRESS has no commit $COMMIT"
cmake -S "$source" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release -DWITHOUT_TESTS=1 >"$folder/build.log" 2>&1 &&
  cmake --build "$folder/build" --target modmqttd -j "$(nproc)" >>"$folder/build.log" 2>&1 ||
  skip "mqmgateway does not build; see $folder/build.log"
echo "$folder/build/modmqttd/modmqttd"
