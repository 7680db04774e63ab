// A search for the greatest value that trials bear.
#include "tmcl/plan/limit_search.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace tmcl::plan {
namespace {

struct Ended {
  std::optional<double> greatest;
  int trials = 0;
  double greatest_tried = 0;
};

Ended search(LimitSearch::Terms terms, const std::function<bool(double)>& holds) {
  LimitSearch search(terms);
  Ended ended;
  while (const auto value = search.next()) {
    ++ended.trials;
    ended.greatest_tried = std::max(ended.greatest_tried, *value);
    search.tried(*value, holds(*value));
  }
  ended.greatest = search.greatest_held();
  return ended;
}

constexpr LimitSearch::Terms from_10_to_1000{.first = 10, .least = 1, .most = 1000};

TEST(LimitSearch, ComesNearToWhatTrialsBear) {
  for (double limit = 1.1; limit < 1000; limit *= 1.37) {
    const auto ended = search(from_10_to_1000, [&](double value) { return value < limit; });
    ASSERT_TRUE(ended.greatest) << limit;
    EXPECT_LT(*ended.greatest, limit);
    EXPECT_GT(*ended.greatest, limit / 1.02);
    EXPECT_LT(ended.greatest_tried, std::max(10.0, limit) * 1.4 + 1e-9)
        << "it grows by this, not by more";
    EXPECT_LT(ended.trials, 32);
  }
}

TEST(LimitSearch, EndsAtTheGreatestThatMayBeTried) {
  const auto ended = search(from_10_to_1000, [](double) { return true; });
  EXPECT_EQ(ended.greatest, 1000);
}

TEST(LimitSearch, FindsNothingWhereTheLeastIsTooMuch) {
  const auto ended = search(from_10_to_1000, [](double) { return false; });
  EXPECT_FALSE(ended.greatest);
  EXPECT_EQ(ended.trials, 5);
}

TEST(LimitSearch, BelievesAFailureMoreThanWhatHeldBefore) {
  int trials_above = 0;
  const auto holds = [&](double value) { return value < 100 || ++trials_above < 4; };
  const auto ended = search(from_10_to_1000, holds);
  ASSERT_TRUE(ended.greatest);
  EXPECT_LT(*ended.greatest, 1000);
  const auto seldom = search(from_10_to_1000, [&, tried = 0](double value) mutable {
    return value < 500 && (value < 100 || ++tried % 2 == 1);
  });
  ASSERT_TRUE(seldom.greatest);
  EXPECT_LT(*seldom.greatest, 500);
}

TEST(LimitSearch, MakesTheBestAgain) {
  auto terms = from_10_to_1000;
  terms.repetitions = 5;
  int at_most = 0;
  search(terms, [&](double value) {
    at_most += value == 1000 ? 1 : 0;
    return true;
  });
  EXPECT_EQ(at_most, 6);
}

TEST(LimitSearch, IsBounded) {
  auto terms = from_10_to_1000;
  terms.trials = 7;
  EXPECT_EQ(search(terms, [](double value) { return value < 37; }).trials, 7);
}

}  // namespace
}  // namespace tmcl::plan
