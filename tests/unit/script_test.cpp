// What a verb throws reaches whoever runs it, and ends nothing else; what must succeed and does not
// ends the verbs that say so.
#include <memory>
#include <stdexcept>
#include <string>

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

Error refused() { return refusal({}, Status::invalid_value); }

/// Its first exchange.
Script<Result<int>> asking() {
  const auto answer = co_await must(exchange({}));
  co_return answer.reply.value;
}

Script<Result<std::string>> twice(std::shared_ptr<int> held) {
  const auto first = co_await must(asking());
  *held = 2;
  co_return std::to_string(first + co_await must(asking()));
}

Script<Result<void>> handling(std::shared_ptr<int> held, bool& handled) {
  const auto text = co_await twice(held);
  handled = !text;
  co_await must(asking());
  co_return {};
}

/// Lets exchanges end with 21 until `failing`, counted from 0.
template <class T>
T run(Script<T>& script, int failing, int& steps) {
  auto step = script.start({});
  for (steps = 0; step; ++steps) {
    StepResult result;
    if (steps == failing) result.emplace_back(tl::unexpected(refused()));
    if (steps != failing) result.emplace_back(Answer{Reply{0, 0, Status::ok, {}, 21}});
    step = script.resume(std::move(result), {});
  }
  return script.take();
}

TEST(WhatMustSucceed, IsItsValueIfItDoes) {
  auto script = twice(std::make_shared<int>(1));
  int steps = 0;
  EXPECT_EQ(run(script, -1, steps), "42");
  EXPECT_EQ(steps, 2);
}

TEST(WhatMustSucceed, EndsTheScriptsThatSaySo) {
  for (const int failing : {0, 1}) {
    auto held = std::make_shared<int>(1);
    {
      auto script = twice(held);
      int steps = 0;
      const auto result = run(script, failing, steps);
      ASSERT_FALSE(result);
      EXPECT_EQ(result.error().status, Status::invalid_value);
      EXPECT_EQ(steps, failing + 1);
      EXPECT_EQ(*held, failing + 1);
    }
    EXPECT_EQ(held.use_count(), 1);
  }
}

TEST(WhatMustSucceed, LeavesScriptsThatHandleTheError) {
  for (const int failing : {0, 1, 2}) {
    auto held = std::make_shared<int>(1);
    bool handled = false;
    {
      auto script = handling(held, handled);
      int steps = 0;
      EXPECT_EQ(run(script, failing, steps).has_value(), failing < 2);
      EXPECT_EQ(steps, failing == 0 ? 2 : 3);
      EXPECT_EQ(handled, failing < 2);
    }
    EXPECT_EQ(held.use_count(), 1);
  }
}

}  // namespace
}  // namespace tmcl
