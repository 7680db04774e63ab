# shellcheck shell=bash
# bash completion for tmclctl: verbs, options, parameters, commands and registers from the program itself, axes from
# tmcld.

_tmclctl_words() {
  tmclctl "${where[@]}" __complete "$@" 2>/dev/null
}

# Whether a verb must follow.
_tmclctl_is_group() {
  [[ " '' profile mint path program coordinate global firmware lease deadman token settings " == *" ${1:-''} "* ]]
}

_tmclctl() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  local verb=() where=() said=() generator="" model="" arguments=0 i
  COMPREPLY=()

  # What stands before the cursor: how to reach the axes, the verb, and how many arguments it has.
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
      --socket) where=(--socket "${COMP_WORDS[i+1]}"); ((i++)) ;;
      --url | --token-file | --ca) where+=("${COMP_WORDS[i]}" "${COMP_WORDS[i+1]}"); ((i++)) ;;
      --role | --name) ((i++)) ;;
      --generator) generator=${COMP_WORDS[i+1]}; ((i++)) ;;
      --model) model=${COMP_WORDS[i+1]}; ((i++)) ;;
      --direct | --config | --addresses | --timeout | --interval | --for | --to | --by | --svg | --csv | --bus | --change | \
        --sample | --until | --full-steps | --velocity | --acceleration | --show | --with | --as | --resonance | --damping | --distance | --motor | --pulse-div | --ramp-div | \
        --unit-mode | --microsteps | --screw-pitch | --units-per-revolution | --unit | --gear-ratio | --jerk | --deceleration | \
        --bow | --clock | --corner-jump | --microsteps-per-unit | --mode | --bank | --start | --length | --axis | --tolerance | --deviation | --feed | --per-turn | --period | \
        --channel | --rate | --samples | --trigger | --pretrigger | --travel | --report | --last | -w | --write | -r | --read | -o | --output)
        # --by of move takes no value.
        [[ ${COMP_WORDS[i]} == --by && ${verb[*]} == move ]] || ((i++)) ;;
      # Bash splits serial:/dev/ttyACM0 at the colon.
      : | =) ((i++)) ;;
      -*) ;;
      *)
        if _tmclctl_is_group "${verb[*]}"; then
          verb+=("${COMP_WORDS[i]}")
        else
          said+=("${COMP_WORDS[i]}")
          ((arguments++))
        fi ;;
    esac
  done

  # --axis X=AXIS: what stands before the = belongs to --axis.
  if [[ $current == = && ${COMP_WORDS[COMP_CWORD-2]} == --axis ]]; then
    mapfile -t COMPREPLY < <(_tmclctl_words axes)
    return
  fi
  case $previous in
    --csv | --report)
      # The one of simulate is a time.
      [[ ${verb[*]} == "profile simulate" ]] || compopt -o default
      return ;;
    --role)
      mapfile -t COMPREPLY < <(compgen -W "observe operate configure" -- "$current")
      return ;;
    --socket | --config | --svg | -o | --output | -w | --write | -r | --read | --token-file | --ca)
      compopt -o default
      return ;;
    --direct)
      mapfile -t COMPREPLY < <(compgen -W "serial:/dev/ usb: can: tcp: auto" -- "$current")
      compopt -o nospace
      return ;;
    --as)
      mapfile -t COMPREPLY < <(compgen -W "sap tmc c json" -- "$current")
      return ;;
    --show)
      mapfile -t COMPREPLY < <(compgen -W "x,v x,v,a v,a v,a,j x,v,a,j" -- "$current")
      return ;;
    --model)
      mapfile -t COMPREPLY < <(compgen -W "$(_tmclctl_words models)" -- "$current")
      return ;;
    =)
      if [[ ${COMP_WORDS[COMP_CWORD-3]:-} == --axis ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_tmclctl_words axes)" -- "$current")
        return
      fi ;;
    --axis) return ;;
    --channel)
      mapfile -t COMPREPLY < <(compgen -W "$(_tmclctl_words parameters)" -- "$current")
      return ;;
    --generator)
      mapfile -t COMPREPLY < <(compgen -W "$(_tmclctl_words generators)" -- "$current")
      return ;;
    --addresses | --timeout | --interval | --for | --to | --bus | --change | --sample | --until | --full-steps | \
      --velocity | --acceleration | --pulse-div | --ramp-div | --unit-mode | --microsteps | \
      --screw-pitch | --units-per-revolution | --unit | --gear-ratio | --jerk | --deceleration | --bow | --clock | \
      --corner-jump | --microsteps-per-unit | \
      --bank | --start | --length | --tolerance | --deviation | --feed | --per-turn | --period | \
      --rate | --samples | --trigger | --pretrigger) return ;;
    --mode)
      [[ ${verb[*]} == "path run" ]] && mapfile -t COMPREPLY < <(compgen -W "velocity position" -- "$current")
      return ;;
  esac

  local words=""
  if [[ $current == -* ]]; then
    words=$(_tmclctl_words options "${verb[@]}")
  elif _tmclctl_is_group "${verb[*]}"; then
    words=$(_tmclctl_words verbs "${verb[@]}")
  else
    case ${verb[*]}:$arguments in
      "coordinate start":*) ;;
      get:0 | set:0 | move:0 | rotate:0 | stop:0 | state:0 | watch:* | plot:0 | capture:0 | params:0 | ramp:0 | home:0 | verify:0 | \
        store:0 | restore:0 | "coordinate "*:0 | wait:* | "path pause":* | "path resume":* | "path stop":* | \
        "lease run":* | "lease break":0)
        words=$(_tmclctl_words axes) ;;
      line:*)
        # The number behind the = cannot be known.
        [[ $current == = || $previous == = ]] && return
        words=$(_tmclctl_words axes)
        words=${words//$'\n'/$'=\n'}${words:+=}
        compopt -o nospace ;;
      help:*)
        words=$(_tmclctl_words verbs "${said[@]}") ;;
      get:1 | set:1 | store:1 | restore:1) words=$(_tmclctl_words parameters) ;;
      raw:1) words=$(_tmclctl_words commands) ;;
      "program assemble":0 | "program disassemble":0 | "program upload":0 | "program verify":0) compopt -o default ;;
      "firmware info":0 | "firmware check":0 | "firmware upload":0 | "mint check":0 | "mint run":0 | \
        "path check":0 | "path run":0 | "settings load":0 | "settings diff":*) compopt -o default ;;
      "profile solve":*)
        # The number behind the = cannot be known.
        [[ $current == = || $previous == = ]] && return
        words=$(_tmclctl_words quantities)
        compopt -o nospace ;;
      "profile simulate":*)
        if [[ -n $model ]]; then
          # Its value may be in any unit.
          [[ $current == = || $previous == = ]] && return
          words=$(_tmclctl_words parameters | sed 's/$/=/')
          compopt -o nospace
        elif [[ $current == = || $previous == = ]]; then
          # Which register: it stands before the =.
          i=$((COMP_CWORD - 1))
          [[ $previous == = ]] && ((i--))
          words=$(_tmclctl_words registers "$generator" "${COMP_WORDS[i]}")
        else
          words=$(_tmclctl_words registers "$generator")
          compopt -o nospace
        fi
        # Bash takes : and = for words of their own.
        [[ $current == [:=] ]] && current="" ;;
    esac
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}

complete -F _tmclctl tmclctl
