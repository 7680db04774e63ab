# Runs a program of tests as two processes, where one for each test takes longer than the tests; sourced by
# scripts/test and .ci/run.

# tests_in_halves PROGRAM ARGUMENT...: prints the failed tests last; a skipped test counts as failed. A test that takes
# five minutes is ended and named. All tests together have no time limit, so a busy computer fails none.
tests_in_halves() {
  local log status=0
  log=$(mktemp)
  seq 0 1 | GTEST_TOTAL_SHARDS=2 xargs -P 2 -I{} \
    env GTEST_SHARD_INDEX={} TMCL_TEST_SECONDS=300 "$@" --gtest_brief=1 2>&1 | tee "$log" || status=1
  if ((status)) || grep -q '^\[  SKIPPED \]' "$log"; then
    status=1
    echo "failed or did not run, of ${1##*/}:"
    sed -En -e 's/^\[  FAILED  \] ([^ ,]+\.[^ ,]+).*/\t\1/p' -e 's/^(hangs: .*)/\t\1/p' \
      -e 's/^(.*): Skipped$/\t\1: skipped/p' -e 's/^xargs: (.*)/\t\1/p' "$log" | sort -u
  fi
  rm "$log"
  return "$status"
}
