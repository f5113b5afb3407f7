# Bash completion of all programs of Fieldcast. Reads subcommands and options from the program's --help.
_fieldcast() {
  local word=${COMP_WORDS[COMP_CWORD]} program=$1 subcommand="" choices
  if [ "${program##*/}" = fieldcast ] && [ "$COMP_CWORD" -gt 1 ]; then
    subcommand=${COMP_WORDS[1]}
  fi
  # The program lists its protocols when it gets an unknown one.
  if [ "${COMP_WORDS[COMP_CWORD - 1]}" = --protocol ] || { [ "$subcommand" = inspect ] && [ "$COMP_CWORD" -eq 2 ] && [[ $word != -* ]]; }; then
    choices=$("$program" inspect '?' 00 2>&1 | awk '/^  [a-z]/ { print $1 }')
  elif [[ $word == -* ]]; then
    choices=$("$program" ${subcommand:+"$subcommand"} --help 2>/dev/null | grep -oE -- '(^|[ ,])--[a-z-]+' | tr -d ' ,')
  elif [ "${program##*/}" = fieldcast ] && [ "$COMP_CWORD" -eq 1 ]; then
    choices=$("$program" --help 2>/dev/null | awk '/^Subcommands:/ { on = 1; next } /^[^ ]/ { on = 0 } on && /^  [a-z]/ { print $1 }')
  fi
  mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
}
complete -o default -F _fieldcast fieldcast fieldcast-bridge fieldcast-forward fieldcast-port fieldcast-sim fieldcast-station
