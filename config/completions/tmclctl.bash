# shellcheck shell=bash
# bash completion for tmclctl: the program itself knows what may stand at the cursor.

_tmclctl() {
  local line=${COMP_LINE:0:COMP_POINT} typed=() found=() word
  read -ra typed <<<"$line"
  [[ $line == *[[:space:]] ]] && typed+=("")
  local current=${typed[-1]}
  mapfile -t found < <(tmclctl __complete line -- "${typed[@]:1}" 2>/dev/null)
  COMPREPLY=()
  if [[ ${found[0]:-} == :files ]]; then
    compopt -o default
    return
  fi

  # Bash takes : and = for words of their own, and wants what stands behind them.
  local behind=${current##*[:=]}
  local before=${current%"$behind"}
  for word in "${found[@]}"; do
    [[ $word == "$current"* ]] || continue
    COMPREPLY+=("${word#"$before"}")
    [[ $word == *= || $word == *: || $word == */ ]] && compopt -o nospace
  done
}

complete -F _tmclctl tmclctl
