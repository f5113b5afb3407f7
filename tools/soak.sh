#!/usr/bin/env bash
# Runs the whole product for hours while parts of it fail, and checks it each minute (tests/campaign/soak.py has the rules).
#
#   tools/soak.sh --hours H [--seed S] [--lines 32] [--folder DIR] [--bin DIR]
#
# --folder keeps the page, the report, logs, captures and stores. --bin: directory of existing programs. Exit code 1: a rule was broken.
set -euo pipefail
cd "$(dirname "$0")/.."

bin="" words=()
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --bin) bin=${2:?--bin needs a directory}; shift 2 ;;
    *) words+=("$1"); shift ;;
  esac
done
if [ -z "$bin" ]; then
  tools/install.sh test
  tools/build.sh fieldcast fieldcast-sim fieldcast-bridge fieldcast-station fieldcast-forward >&2
  bin=build/bin
fi
server=$(PATH=$PATH:/usr/sbin command -v nats-server || echo build/unpacked/nats-server/usr/sbin/nats-server)
exec /usr/bin/python3 tests/campaign/soak.py --bin "$bin" --nats "$server" "${words[@]}"
