#!/usr/bin/env bash
# Writes a program's compressed manual page from the --help output of the program and its subcommands.
#
#   tools/packaging/manual.sh PROGRAM VERSION PAGE.1.gz
set -euo pipefail
program=$1 version=$2 page=$3
name=$(basename "$program")

# Escapes backslashes, dots and hyphens for troff.
plain() { sed -E -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^([.'])/\\\\\&\1/"; }
section() { printf '.SH "%s"\n.nf\n' "$1"; plain; printf '.fi\n'; }

help=$("$program" --help)
{
  printf '.TH "%s" 1 "" "Fieldcast %s" "Fieldcast"\n.SH NAME\n' "${name^^}" "$version"
  printf '%s \\- %s\n' "$name" "$(head -1 <<<"$help" | sed 's/\.$//' | plain)"
  section USAGE <<<"$help"
  if [ "$name" = fieldcast ]; then
    for command in $(awk '/^Subcommands:/ { on = 1; next } /^[^ ]/ { on = 0 } on && /^  [a-z]/ { print $1 }' <<<"$help"); do
      "$program" "$command" --help | section "fieldcast $command"
    done
  fi
  printf '.SH FILES\n.TP\n.I /etc/fieldcast/NAME.yaml\nThe configuration of the service fieldcast\\-bridge@NAME.\n'
  printf '.TP\n.I /etc/fieldcast/station.yaml\nThe configuration of the service fieldcast\\-station.\n'
  printf '.TP\n.I share/fieldcast/examples\nConfigurations to begin with.\n'
} | gzip -9nc >"$page.new"
mv "$page.new" "$page"
