#!/usr/bin/env bash
# Writes a program's compressed manual page from the --help output of the program and its subcommands.
#
#   tools/packaging/manual.sh PROGRAM VERSION PAGE.1.gz
set -euo pipefail
program=$1 version=$2 page=$3
name=$(basename "$program")
date=$(date -u -d "$(sed -n 's/^ -- .*>  //p' "$(dirname "$0")/debian/changelog" | head -1)" +%F)

# Reads a help text of CLI11 and prints its parts: "page" for a program, "command" for a subcommand, "exit" for the exit codes.
parts() {
  awk -v part="$1" '
    # Escapes backslashes and hyphens for troff, and a dot or an apostrophe that begins a line.
    function plain(text) { gsub(/\\/, "\\e", text); gsub(/-/, "\\-", text); sub(/^[.\047]/, "\\\\\\&&", text); return text }
    # "--server TEXT" with the name of the option in bold and its value in italics.
    function item(text,    names, value) {
      names = value = text
      sub(/ .*/, "", names); sub(/^[^ ]* ?/, "", value)
      names = plain(names)
      gsub(/,/, "\\fR, \\fB", names)
      return "\\fB" names "\\fR" (value == "" ? "" : " \\fI" plain(value) "\\fR")
    }
    /^Usage: / { usage = substr($0, 8); next }
    usage == "" { about = about plain($0) "\n"; next }
    /^[A-Z][a-z]+:$/ { list = $0; next }
    /^ +[^ ]/ && list ~ /^(Positionals|Options):$/ {
      row = $0
      if (row ~ /^  [^ ]/) {
        sub(/^  /, "", row)
        head = row; sub(/  .*/, "", head)
        items = items ".TP\n" item(head) "\n"
        row = substr(row, length(head) + 1)
      }
      sub(/^ +/, "", row)
      if (row != "") items = items plain(row) "\n"
      next
    }
    /^[Ee]xit codes: / { codes = $0; sub(/^[^:]*: /, "", codes); sub(/\.$/, "", codes); next }
    /^[^ ]/ { notes = notes ".PP\n" plain($0) "\n" }
    END {
      if (part == "exit") {
        while (codes != "") {
          split_at = match(codes, /, [0-9]+ /)
          code = split_at ? substr(codes, 1, split_at - 1) : codes
          codes = split_at ? substr(codes, split_at + 2) : ""
          printf ".TP\n.B %s\n%s\n", code + 0, plain(substr(code, index(code, " ") + 1))
        }
        exit
      }
      if (part == "command") printf ".SS \"%s\"\n%s", plain(usage), about
      else printf ".SH SYNOPSIS\n.B %s\n.SH DESCRIPTION\n%s%s.SH OPTIONS\n", plain(usage), about, notes
      printf "%s%s", items, part == "command" ? notes : ""
    }'
}

# Prints the subcommands of "PROGRAM WORD..", each followed by its own.
commands() {
  local command
  for command in $("$program" "$@" --help | awk '/^Subcommands:/ { on = 1; next } /^[^ ]/ { on = 0 } on && /^  [a-z]/ { print $1 }'); do
    "$program" "$@" "$command" --help | parts command
    commands "$@" "$command"
  done
}

help=$("$program" --help)
{
  printf '.TH "%s" 1 "%s" "Fieldcast %s" "Fieldcast"\n.SH NAME\n' "${name^^}" "$date" "$version"
  printf '%s \\- %s\n' "$name" "$(head -1 <<<"$help" | sed -e 's/\.$//' -e 's/-/\\-/g')"
  parts page <<<"$help"
  found=$(commands)
  [ -z "$found" ] || printf '.SH COMMANDS\n%s\n' "$found"
  printf '.SH "EXIT STATUS"\n'
  parts exit <<<"$help"
  printf '.SH FILES\n.TP\n.I /etc/fieldcast/NAME.yaml\nThe configuration of the service fieldcast\\-bridge@NAME.\n'
  printf '.TP\n.I /etc/fieldcast/station.yaml\nThe configuration of the service fieldcast\\-station.\n'
  printf '.TP\n.I /etc/fieldcast/forward.yaml\nThe configuration of the service fieldcast\\-forward.\n'
  printf '.TP\n.I /usr/share/fieldcast/examples\nConfigurations to begin with.\n.TP\n.I /usr/share/doc/fieldcast\nThe documents.\n'
  printf '.SH "SEE ALSO"\n'
  printf '%s\n' fieldcast fieldcast-bridge fieldcast-forward fieldcast-port fieldcast-sim fieldcast-station |
    sed -e "/^$name\$/d" -e 's/-/\\-/g' -e 's/.*/.BR & (1),/' -e '$s/,$//' | sed '$s/),$/)/'
} | gzip -9nc >"$page.new"
mv "$page.new" "$page"
