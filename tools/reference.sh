#!/usr/bin/env bash
# Generates the reference of the station library in build/reference/html. Fails on any warning from Doxygen.
#
#   tools/reference.sh
set -euo pipefail
cd "$(dirname "$0")/.."

command -v doxygen >/dev/null || tools/install.sh reference
mkdir -p build/reference
doxygen docs/Doxyfile
echo "build/reference/html/index.html"
