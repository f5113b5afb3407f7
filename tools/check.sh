#!/usr/bin/env bash
# Checks format, spelling, boundaries of folders and words of all sources, the messages of new commits, and runs clang-tidy on
# changed sources.
#
#   tools/check.sh [COMMIT]
#
# COMMIT: base of the comparison. Default: the merge base with origin/main or main; on that branch itself, the previous commit.
# Checks at most the 12 most changed files, which needs a minute, and prints how many it skipped.
# `run-clang-tidy-14 -p build-tidy` checks all files.
set -euo pipefail
cd "$(dirname "$0")/.."

most=12
fail() { echo "tools/check.sh: $*" >&2; exit 1; }
for program in clang-format clang-tidy codespell; do
  command -v "$program" >/dev/null || fail "$program is missing: tools/install.sh ci"
done

# Allows a checkout owned by another user.
git() { command git -c safe.directory="$PWD" "$@"; }
mapfile -t sources < <(find bridge config core idl tests tools '(' -name '*.cpp' -o -name '*.hpp' -o -name '*.c' -o -name '*.h' ')')
clang-format --dry-run -Werror "${sources[@]}" || fail "not formatted; run: clang-format -i on the files above"
codespell bridge config core docs idl tests tools ./*.md .ci/run ||
  fail "misspelt, see above"

# The figures of the tree, with their limits.
python3 tests/tools/boundaries.py . || fail "a boundary is crossed, see above"
words=$(python3 tests/docs/language.py .) || fail "words to avoid: $words; see: python3 tests/docs/language.py . PATH"
echo "words of CONTRIBUTING.md, 'Language': ${words%% *}"
ways=$(python3 tests/docs/ways_test.py . 2>&1) || fail "a way is not as tests/docs/ways.txt lists it: $ways"
grep '^way of ' <<<"$ways"
public=(bridge/client/include/fieldcast/*.hpp)
lines=$(cat "${public[@]}" | wc -l)
echo "headers of the station library: ${#public[@]}, $lines lines"
[ "${#public[@]}" -le 6 ] && [ "$lines" -le 700 ] || fail "the station library has at most 6 headers with 700 lines"

base=${1:-}
head=$(git rev-parse HEAD 2>/dev/null) || { echo "clang-tidy: no git checkout, nothing to compare with"; exit 0; }
for branch in origin/main main HEAD~1; do
  [ -z "$base" ] || break
  base=$(git merge-base HEAD "$branch" 2>/dev/null || true)
  [ "$base" != "$head" ] || base=""
done
[ -n "$base" ] || { echo "clang-tidy: one commit, nothing to compare with"; exit 0; }

message=$(mktemp)
trap 'rm -f "$message"' EXIT
while read -r commit; do
  git log -1 --format=%B "$commit" >"$message"
  tools/hooks/commit-msg "$message" || fail "the message of commit ${commit:0:9}, see above"
done < <(git rev-list --no-merges "$base..HEAD")

# Without the example, which a test compiles against the installed headers, and without sources for Windows.
mapfile -t changed < <(git diff --numstat --diff-filter=AMR "$base" -- '*.cpp' ':!tools/packaging/example' ':!tools/program-port/windows' | sort -rn | cut -f3 | grep -v '[{}]')
present=()
for file in "${changed[@]}"; do [ ! -f "$file" ] || present+=("$file"); done
[ "${#present[@]}" -gt 0 ] || { echo "clang-tidy: no source changed since ${base:0:9}"; exit 0; }
checked=("${present[@]:0:$most}")
echo "clang-tidy: ${#checked[@]} of ${#present[@]} files that changed since ${base:0:9}"

# A separate build: clang cannot use GCC's precompiled headers, and sources of a unity build have no compile commands.
cmake -S . -B build-tidy -G Ninja -DFIELDCAST_PCH=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
ninja -C build-tidy idl/generated/idl/topics.h tools/forward/schema/{forward,remote_write,sparkplug}.pb.h >/dev/null
printf '%s\n' "${checked[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build-tidy --quiet 2>/dev/null ||
  fail "clang-tidy, see above"
