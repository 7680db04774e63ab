// What a verb throws reaches whoever runs it, and ends nothing else.
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tmcl/script.hpp"

namespace tmcl {
namespace {

Script<int> inner(bool at_once) {
  if (!at_once) co_await pause(Duration{});
  throw std::runtime_error("injected");
}

Script<int> outer(bool at_once, bool& went_on, std::shared_ptr<int> held) {
  const auto got = co_await inner(at_once);
  went_on = true;
  co_return got + *held;
}

class ThrowingScript : public testing::TestWithParam<bool> {};

TEST_P(ThrowingScript, TellsItsRunnerAndLeavesNothing) {
  bool went_on = false;
  auto held = std::make_shared<int>(1);
  {
    auto script = outer(GetParam(), went_on, held);
    if (GetParam()) {
      EXPECT_THROW(script.start({}), std::runtime_error);
    } else {
      ASSERT_TRUE(script.start({}));
      EXPECT_THROW(script.resume({}, {}), std::runtime_error);
    }
    EXPECT_EQ(held.use_count(), 2);
  }
  EXPECT_FALSE(went_on);
  EXPECT_EQ(held.use_count(), 1);
}

INSTANTIATE_TEST_SUITE_P(AtEachStep, ThrowingScript, testing::Bool());

}  // namespace
}  // namespace tmcl
