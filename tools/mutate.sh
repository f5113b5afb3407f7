#!/usr/bin/env bash
# Makes small changes of core, one at a time, and counts how many the unit tests notice. tests/mutation/mutate.py has the rules.
#
#   tools/mutate.sh [--mutants N] [--seed S] [--minutes M] [--under core/PART] [--jobs J] [--folder DIR]
#
# Default: 2 000 mutants of seed 1, in build-mutants. It compiles for ten to twenty minutes. A second run continues the first.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install.sh coverage
ulimit -v 6000000 -c 0  # a mutant may allocate without end
exec /usr/bin/python3 tests/mutation/mutate.py "$@"
