# Runs the stages of a check and says how long each takes; sourced by .ci/run.
#
#     stage NAME COMMAND...    runs the command; when it fails, all ends
#     lane FUNCTION            begins the stages of a function, which run beside those that follow
#     lanes_end                waits for the lanes
#
# What a stage prints goes into a log of its own, which is shown when the stage fails. The last line of
# all names the stage that failed first.

stage_logs=build/stages
stage_failures=$stage_logs/failed
stage_monitor=-m   # gives each stage a process group of its own; the stages of a lane have that of the lane
stage_groups=()

stages_begin() {
  rm -rf "$stage_logs"
  mkdir -p "$stage_logs"
  : >"$stage_failures"
  trap _stages_end EXIT
  trap 'exit 1' USR1   # from a lane that failed
}

_stages_kill() {
  local group
  for group in "${stage_groups[@]}"; do kill -- "-$group" 2>/dev/null || true; done
}

_stages_end() {
  local status=$?
  _stages_kill
  wait
  _stages_kill   # what was being started
  ((status == 0)) || echo "== FAILED: $(head -n 1 "$stage_failures" | grep . || echo "no stage; interrupted")" >&2
}

# In the background even where it is waited for, so that a signal ends it at once.
_stage_begin() {
  set "$stage_monitor"
  "$@" &
  set +m
  [[ $stage_monitor == +m ]] || stage_groups+=("$!")
}

# As the last line of the log it says how long the command took.
_stage_timed() {
  set +m
  local TIMEFORMAT='%0R s, %0U + %0S s of processor time'
  time "$@"
}

_stage_failed() {
  echo "$1" >>"$stage_failures"
  cat "$2"
  echo "== $1: FAILED"
  [[ $stage_monitor == -m ]] || kill -USR1 "$$"
  exit 1
}

stage() {
  local name=$1 log=$stage_logs/${1//[^[:alnum:]]/_}.log
  shift
  echo "== $name"
  _stage_begin _stage_timed "$@" >"$log" 2>&1
  wait "$!" || _stage_failed "$name" "$log"
  echo "== $name: done in $(tail -n 1 "$log")"
}

_lane() {
  set +m
  stage_monitor=+m
  "$@"
}

lane() { _stage_begin _lane "$@"; }

lanes_end() {
  local group
  for group in "${stage_groups[@]}"; do wait "$group" || exit 1; done
}
