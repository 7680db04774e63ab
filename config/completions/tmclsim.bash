# shellcheck shell=bash
# bash completion for tmclsim, tmcld and tmcld-mqtt: the options that their help lists.

_tmcl_by_help() {
  local program=$1 current=$2 previous=$3
  COMPREPLY=()
  if [[ $program == tmclsim && $previous == --module ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(tmclctl __complete models 2>/dev/null)" -- "$current")
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u)" -- "$current")
  else
    compopt -o default
  fi
}

complete -F _tmcl_by_help tmclsim tmcld tmcld-mqtt
