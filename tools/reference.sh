#!/usr/bin/env bash
# Writes the reference of the station library to build/reference/html; fails on a warning of Doxygen.
#
#   tools/reference.sh
set -euo pipefail
cd "$(dirname "$0")/.."

command -v doxygen >/dev/null || tools/install.sh reference
mkdir -p build/reference
doxygen docs/Doxyfile
echo "build/reference/html/index.html"
