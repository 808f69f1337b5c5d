# Completion of softfinger for bash: the program itself says what fits.
_softfinger() {
  local candidates
  mapfile -t candidates < <("$1" complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  COMPREPLY=("${candidates[@]%%$'\t'*}")
}
complete -o default -F _softfinger softfinger
