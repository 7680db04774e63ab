// A search that has begun was sent, whatever becomes of the questions that follow.
#include <gtest/gtest.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

TEST(HomeOutcome, OfASearchWhoseModuleFallsSilentIsNotThatNothingWasSent) {
  JourneyBench bench;
  const auto pending = bench.begin("axis.home", {{"axis", "x"}, {"timeout_ms", 0}});
  bench.time.run_for(std::chrono::milliseconds(300));
  ASSERT_EQ(bench.sent(tmcl::Command::RFS).front().type, 0) << "it has begun";
  bench.wire.is_cut = true;
  const auto ended = bench.end_of(pending);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().outcome, tmcl::Outcome::unknown) << ended.error().message;
}

}  // namespace
}  // namespace tmcld::test
