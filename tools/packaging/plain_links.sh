#!/usr/bin/env bash
# Replaces each relative link in the installed documents whose target is not installed, for example a source file, by its text.
#
#   tools/packaging/plain_links.sh FOLDER
#
# FOLDER has the installed documents in the structure of the source tree.
set -euo pipefail
cd "$1"
there=$(find -L . -mindepth 1 | sed 's|^\./||')

find . -name '*.md' | sed 's|^\./||' | while read -r document; do
  awk -v document="$document" '
    # Returns the path of a link below FOLDER.
    function target(link,    parts, count, kept, i, path) {
      sub(/#.*/, "", link)
      sub(/\/$/, "", link)
      if (link == "") return document
      path = document
      if (!sub(/\/[^\/]*$/, "/", path)) path = ""
      count = split(path link, parts, "/")
      kept = 0
      for (i = 1; i <= count; ++i) {
        if (parts[i] == "..") --kept
        else if (parts[i] != ".") parts[++kept] = parts[i]
      }
      path = parts[1]
      for (i = 2; i <= kept; ++i) path = path "/" parts[i]
      return path
    }
    NR == FNR { there[$0] = 1; next }
    /^ *```/ { fenced = !fenced }
    fenced { print; next }
    {
      rest = $0
      line = ""
      while (match(rest, /\[[^][]*\]\([^() ]+\)/)) {
        whole = substr(rest, RSTART, RLENGTH)
        split_at = index(whole, "](")
        link = substr(whole, split_at + 2, length(whole) - split_at - 2)
        if (link !~ /:\/\// && !(target(link) in there)) whole = substr(whole, 2, split_at - 2)
        line = line substr(rest, 1, RSTART - 1) whole
        rest = substr(rest, RSTART + RLENGTH)
      }
      print line rest
    }' - "$document" <<<"$there" >"$document.new"
  if cmp -s "$document" "$document.new"; then rm "$document.new"; else mv "$document.new" "$document"; fi
done
