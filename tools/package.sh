#!/usr/bin/env bash
# Builds the Debian packages fieldcast, fieldcast-dev, fieldcast-sim and libfieldcast-station1 in build/packages.
#
#   tools/package.sh
#
# Installs missing packages (tools/install.sh package). Prints the new files.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install.sh package
tools/build.sh packaged
cpack --config build/CPackConfig.cmake -B build/packages >build/packages.log 2>&1 || { cat build/packages.log >&2; exit 1; }
ls -l build/packages/*.deb
