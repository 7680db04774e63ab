# How long the programs take to build; sourced by scripts/demo, and by the test of what README.md says.

# Measured with g++ 12: 1,006 s of processor time for 54 steps, each of several sources. On other days the same
# virtual machine took two thirds of that.
readonly tenths_of_second_per_step=186

# minutes_to_build STEPS PROCESSORS: rounded.
minutes_to_build() { echo $((($1 * tenths_of_second_per_step / 10 / $2 + 30) / 60)); }

# time_left STEP STEPS SECONDS: after so many steps of all have taken so many seconds.
time_left() {
  local seconds=$(($3 * ($2 - $1) / $1))
  if ((seconds < 60)); then echo "$seconds s"; else echo "$(((seconds + 30) / 60)) min"; fi
}
