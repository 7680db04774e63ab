# shellcheck shell=bash
# bash completion for tmclctl: the program itself knows what may stand at the cursor.

_tmclctl() {
  local typed=() found=() word joins=""

  # Bash takes : and = for words of their own.
  for word in "${COMP_WORDS[@]:1:COMP_CWORD}"; do
    if [[ ${#typed[@]} -gt 0 && ( -n $joins || $word == [:=] ) ]]; then
      typed[-1]+=$word
    else
      typed+=("$word")
    fi
    joins=""
    [[ $word != [:=] ]] || joins=yes
  done
  mapfile -t found < <(tmclctl __complete line -- "${typed[@]}" 2>/dev/null)
  COMPREPLY=()
  if [[ ${found[0]:-} == :files ]]; then
    compopt -o default
    return
  fi

  # It wants what stands behind them.
  local current=${typed[-1]} behind=${COMP_WORDS[COMP_CWORD]}
  [[ $behind != [:=] ]] || behind=""
  local before=${current%"$behind"}
  for word in "${found[@]}"; do
    [[ $word == "$current"* ]] || continue
    COMPREPLY+=("${word#"$before"}")
    [[ $word == *[=:/] ]] && compopt -o nospace
  done
}

complete -F _tmclctl tmclctl
