// Homing, coordinates, ports and what else is asked of modules: the bytes, and what refusals mean.
// That no fault makes them wrong is tested in verbs_test.cpp.

#include <gmock/gmock.h>

#include "support/scripted_bus.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using test::Fault;
using test::ScriptedBus;
using testing::ElementsAre;

constexpr ModuleAddress module{1};
constexpr AxisAddress axis{module, 2};

constexpr Request search(std::uint8_t type) { return {module, Command::RFS, type, 2, 0}; }

TEST(Homing, SetsTheModeStartsAndAsksUntilTheModuleIsDone) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.parameter(2, 197) = -40;
  fake.parameter(2, 196) = 5000;
  std::vector<std::int32_t> steps;
  const auto homed = bus.run(verbs::home(axis, {.mode = 66, .progress = [&](std::int32_t step) {
                                                  steps.push_back(step);
                                                  return true;
                                                }}));
  ASSERT_TRUE(homed);
  EXPECT_EQ(homed->correction, Microsteps{-40});
  EXPECT_EQ(homed->switch_distance, Microsteps{5000});
  EXPECT_THAT(steps, ElementsAre(1, 2, 3));
  EXPECT_EQ(bus.sent()[0], (Request{module, Command::GAP, 193, 2, 0}));
  EXPECT_EQ(bus.sent()[1], (Request{module, Command::SAP, 193, 2, 66}));
  EXPECT_EQ(bus.sent()[2], search(0));
  EXPECT_EQ(bus.sent()[3], search(2));
}

// What another search has measured is not told as if this one had.
TEST(Homing, TellsWhatThisSearchHasMeasured) {
  for (int mode = 1; mode <= 136; ++mode) {
    for (const bool is_given : {true, false}) {
      ScriptedBus bus;
      auto& fake = bus.add_module(1);
      fake.parameter(2, 193) = is_given ? 2 : mode;
      fake.parameter(2, 196) = 5000;
      HomeOptions options;
      if (is_given) options.mode = mode;
      const auto homed = bus.run(verbs::home(axis, options));
      ASSERT_TRUE(homed);
      const bool visits_both = mode == 2 || mode == 3 || mode == 66 || mode == 67;
      EXPECT_EQ(homed->switch_distance.has_value(), visits_both) << mode;
      EXPECT_TRUE(homed->correction);
    }
  }
}

TEST(Homing, TellsNothingOfASearchThatWasStopped) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.before = [](test::FakeModule& self, const Request& request) {
    // It is stopped somewhere.
    if (request.command == Command::GAP) self.parameter(2, axis_parameter::actual_position) = 77;
  };
  const auto homed = bus.run(verbs::home(axis, {.mode = 2}));
  ASSERT_TRUE(homed);
  EXPECT_FALSE(homed->correction);
  EXPECT_FALSE(homed->switch_distance);
}

TEST(Homing, AModeThatTheModuleRefusesDoesNotStay) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.parameter(2, 193) = 3;
  fake.refuse = [](const Request& request) {
    return request == search(0) ? std::optional(Status::invalid_value) : std::nullopt;
  };
  const auto homed = bus.run(verbs::home(axis, {.mode = 20}));
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().outcome, Outcome::refused);
  EXPECT_THAT(homed.error().hint, testing::HasSubstr("193 is 3 again"));
  EXPECT_EQ(fake.parameter(2, 193), 3);
  ASSERT_FALSE(bus.run(verbs::start_reference_search(axis, 20)));
  EXPECT_EQ(fake.parameter(2, 193), 3);
}

TEST(Homing, AModuleThatDoesNotTellItsModeMaySearchAllTheSame) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.refuse = [](const Request& request) {
    return request.command == Command::GAP && request.type == 193
               ? std::optional(Status::wrong_type)
               : std::nullopt;
  };
  EXPECT_TRUE(bus.run(verbs::home(axis, {.mode = 5})));
  EXPECT_EQ(fake.parameter(2, 193), 5);
}

TEST(Homing, LeavesTheModeAloneUnlessAsked) {
  ScriptedBus bus;
  bus.add_module(1);
  ASSERT_TRUE(bus.run(verbs::home(axis)));
  EXPECT_EQ(bus.sent()[0], search(0));
}

TEST(Homing, AModuleThatFallsSilentWhileItSearchesIsAskedAgain) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.parameter(2, 197) = -40;
  // The start and the first look are answered, the next six datagrams are lost.
  bus.chance = [&](std::size_t datagram) {
    return datagram >= 2 && datagram < 8 ? std::optional(Fault::lost_request) : std::nullopt;
  };
  std::vector<std::int32_t> steps;
  const auto homed = bus.run(verbs::home(axis, {.progress = [&](std::int32_t step) {
                                           steps.push_back(step);
                                           return true;
                                         }}));
  ASSERT_TRUE(homed) << describe(homed.error());
  EXPECT_EQ(homed->correction, Microsteps{-40});
  EXPECT_THAT(steps, ElementsAre(1, 2, 3)) << "each once: a look that is lost is no look";
  EXPECT_EQ(std::ranges::count(bus.sent(), search(0)), 1) << "the search is not started again";
  // What the module was asked: where its search is, four times; that it has ended, twice more.
  EXPECT_EQ(std::ranges::count(fake.executed(), search(2)), 6);
  EXPECT_EQ(bus.counters().timeouts, 6U);
}

TEST(Homing, ButNotForEver) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.chance = [&](std::size_t datagram) {
    return datagram >= 2 ? std::optional(Fault::lost_request) : std::nullopt;
  };
  const auto homed = bus.run(verbs::home(axis, {.silence_limit = 1s}));
  ASSERT_FALSE(homed);
  EXPECT_TRUE(homed.error().code == Errc::reply_timeout ||
              homed.error().code == Errc::module_silent);
  EXPECT_LT(bus.clock().now(), TimePoint{} + 20s);
}

TEST(Homing, EndsAtItsTimeoutAndSaysThatTheSearchGoesOn) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.before = [](test::FakeModule& self, const Request& request) {
    if (request == search(2)) self.execute_quietly(search(0));
  };
  const auto homed = bus.run(verbs::home(axis, {.timeout = 300ms}));
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().code, Errc::deadline_passed);
  EXPECT_EQ(homed.error().outcome, Outcome::done);
  EXPECT_THAT(homed.error().hint, testing::HasSubstr("goes on"));
  EXPECT_EQ(std::ranges::count(bus.sent(), search(1)), 0);
}

TEST(Homing, EndsAtItsTimeoutHoweverLongTheLooksTake) {
  for (const Duration exchange : {1ms, 81ms, 400ms}) {
    ScriptedBus bus(Framing::serial, {.name = "bench", .reply_timeout = 500ms});
    bus.answer_time = exchange;
    auto& fake = bus.add_module(1);
    fake.before = [&](test::FakeModule& self, const Request& request) {
      const bool in_time = bus.clock().now() <= TimePoint{} + 1s + exchange;
      if (request == search(2) && in_time) self.execute_quietly(search(0));
    };
    const auto homed = bus.run(verbs::home(axis, {.mode = 1, .timeout = 1s}));
    ASSERT_FALSE(homed);
    EXPECT_EQ(homed.error().code, Errc::deadline_passed);
    EXPECT_GE(bus.clock().now(), TimePoint{} + 1s);
    EXPECT_LE(bus.clock().now(), TimePoint{} + 1s + exchange);
    // The mode is read and set, the search is started, and looked at.
    const bool was_seen = 4 * exchange <= 1s;
    EXPECT_EQ(homed.error().message.ends_with(": step 1"), was_seen) << homed.error().message;
  }
}

TEST(Homing, EndsAtItsTimeoutWhereTheModuleIsSilent) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing, {.name = "bench", .reply_timeout = 100ms});
    bus.add_module(1);
    bus.chance = [&](std::size_t datagram) {
      return datagram >= 1 ? std::optional(Fault::lost_request) : std::nullopt;
    };
    const auto homed = bus.run(verbs::home(axis, {.timeout = 1s}));
    ASSERT_FALSE(homed);
    EXPECT_EQ(homed.error().code, Errc::deadline_passed) << "less than silence_limit";
    EXPECT_LE(bus.clock().now(), TimePoint{} + 1s + 110ms) << "one exchange, and the wire's quiet";
  }
}

TEST(Homing, ASearchForWhichThereIsNoTimeIsNotStarted) {
  ScriptedBus bus(Framing::serial, {.name = "bench", .reply_timeout = 500ms});
  bus.add_module(1);
  bus.answer_time = 400ms;
  const auto homed = bus.run(verbs::home(axis, {.mode = 1, .timeout = 300ms}));
  ASSERT_FALSE(homed);
  EXPECT_EQ(homed.error().code, Errc::deadline_passed);
  EXPECT_EQ(homed.error().outcome, Outcome::not_sent);
  EXPECT_EQ(std::ranges::count(bus.sent(), search(0)), 0);
}

TEST(Homing, ALostAnswerToTheStartIsSettledByTheStatus) {
  ScriptedBus executed;
  executed.add_module(1);
  executed.fail(0, Fault::lost_reply);
  EXPECT_TRUE(executed.run(verbs::start_reference_search(axis)));
  ScriptedBus lost;
  lost.add_module(1);
  lost.fail(0, Fault::lost_request);
  const auto started = lost.run(verbs::start_reference_search(axis));
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().outcome, Outcome::unknown);
}

TEST(Homing, AResultThatTheModuleDoesNotHaveIsNoError) {
  ScriptedBus bus;
  auto& fake = bus.add_module(1);
  fake.refuse = [](const Request& request) {
    return request.command == Command::GAP && request.type == 196
               ? std::optional(Status::wrong_type)
               : std::nullopt;
  };
  const auto homed = bus.run(verbs::home(axis));
  ASSERT_TRUE(homed);
  EXPECT_TRUE(homed->correction);
  EXPECT_FALSE(homed->switch_distance);
}

TEST(Coordinates, TheEepromFormsHaveMotor255) {
  ScriptedBus bus;
  bus.add_module(1);
  ASSERT_TRUE(bus.run(verbs::store_coordinates(module)));
  ASSERT_TRUE(bus.run(verbs::store_coordinates(module, 20)));
  ASSERT_TRUE(bus.run(verbs::load_coordinates(module)));
  EXPECT_THAT(bus.sent(), ElementsAre(Request{module, Command::SCO, 0, 255, 0},
                                      Request{module, Command::SCO, 20, 255, 0},
                                      Request{module, Command::GCO, 0, 255, 0}));
}

TEST(Coordinates, NumbersThatDoNotExistAreRefusedUnsent) {
  ScriptedBus bus;
  bus.add_module(1);
  EXPECT_EQ(bus.run(verbs::set_coordinate(axis, 21, {0})).error().code, Errc::bad_argument);
  EXPECT_EQ(bus.run(verbs::move_to_coordinate(axis, 21)).error().code, Errc::bad_argument);
  EXPECT_EQ(bus.run(verbs::store_coordinates(module, 0)).error().code, Errc::bad_argument);
  EXPECT_EQ(bus.run(verbs::move_motors_to_coordinate(module, {0}, Together::interpolated, 1))
                .error()
                .code,
            Errc::bad_argument);
  EXPECT_TRUE(bus.sent().empty());
}

TEST(Coordinates, SeveralMotorsAreNamedByAMask) {
  ScriptedBus bus;
  bus.add_module(1);
  ASSERT_TRUE(
      bus.run(verbs::move_motors_to_coordinate(module, {0b101}, Together::each_for_itself, 4)));
  ASSERT_TRUE(
      bus.run(verbs::move_motors_to_coordinate(module, {0b101}, Together::interpolated, 4)));
  EXPECT_THAT(bus.sent(), ElementsAre(Request{module, Command::MVP, 2, 0x85, 4},
                                      Request{module, Command::MVP, 2, 0x45, 4}));
}

TEST(Ports, ALostAnswerToAnOutputIsSettledByReadingIt) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.fail(0, Fault::lost_reply);
  EXPECT_TRUE(bus.run(verbs::set_output(module, 3, 1)));
  EXPECT_EQ(std::ranges::count(bus.module(1).executed(), Command::SIO, &Request::command), 1);
}

TEST(ModuleVerbs, ResetsAreSentWithTheNumberThatMeansThem) {
  ScriptedBus bus;
  bus.add_module(1);
  ASSERT_TRUE(bus.run(verbs::reset_module(module)));
  ASSERT_TRUE(bus.run(verbs::factory_reset(module)));
  EXPECT_EQ(bus.sent()[0], (Request{module, Command::SOFTWARE_RESET, 0, 0, 1234}));
  EXPECT_EQ(bus.sent()[1], (Request{module, Command::FACTORY_RESET, 0, 0, 1234}));
}

TEST(ModuleVerbs, WhatGetInfoDoesNotKnowIsLeftOut) {
  ScriptedBus bus;
  bus.add_module(1);
  const auto info = bus.run(verbs::firmware_info(module));
  ASSERT_TRUE(info);
  EXPECT_EQ(info->bootloader_id, 4'000'010);
  EXPECT_FALSE(info->git_hash);
}

}  // namespace
}  // namespace tmcl
