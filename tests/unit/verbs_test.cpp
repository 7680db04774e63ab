// Every verb, with every datagram of it failing in every way, on a serial line and on CAN.

#include <gmock/gmock.h>

#include <set>
#include <tuple>

#include "support/data_logger.hpp"
#include "support/scripted_bus.hpp"
#include "tmcl/data_logger.hpp"
#include "tmcl/readings_at_rest.hpp"
#include "unit/engine_requests.hpp"

namespace tmcl {
namespace {

using test::commands_of;
using test::Fault;
using test::ScriptedBus;
using testing::ElementsAre;

constexpr AxisAddress axis{ModuleAddress{1}, 2};

/// A verb, its result as text so that all verbs are treated alike, and what it may leave behind.
struct Case {
  std::string name;
  std::function<std::string(ScriptedBus&)> run;
};

std::string text_of(const Error& error) {
  return std::string("error ") + std::string(name_of(error.outcome));
}

template <class T, class Show>
std::string show(const Result<T>& result, Show show_value) {
  return result ? show_value(*result) : text_of(result.error());
}

std::string done(const Result<void>& result) { return result ? "done" : text_of(result.error()); }
std::string count(const Result<std::int32_t>& result) {
  return show(result, [](std::int32_t value) { return std::to_string(value); });
}
std::string place(const Result<Microsteps>& result) {
  return show(result, [](Microsteps value) { return std::to_string(value.value); });
}

CaptureSetup short_capture() {
  return {{capture_channel(axis.motor, 1), capture_channel(axis.motor, 3)}, 2, 0, 1, {}};
}

std::vector<Case> all_verbs() {
  return {
      {"get", [](ScriptedBus& bus) { return count(bus.run(verbs::get(axis, 4))); }},
      {"set", [](ScriptedBus& bus) { return done(bus.run(verbs::set(axis, 4, 1234))); }},
      {"set target", [](ScriptedBus& bus) { return done(bus.run(verbs::set(axis, 0, 1234))); }},
      {"get_global",
       [](ScriptedBus& bus) { return count(bus.run(verbs::get_global(axis.module, 0, 66))); }},
      {"set_global",
       [](ScriptedBus& bus) { return done(bus.run(verbs::set_global(axis.module, 0, 68, 500))); }},
      {"move_to", [](ScriptedBus& bus) { return place(bus.run(verbs::move_to(axis, {51200}))); }},
      {"move_by", [](ScriptedBus& bus) { return place(bus.run(verbs::move_by(axis, {-100}))); }},
      {"rotate", [](ScriptedBus& bus) { return done(bus.run(verbs::rotate(axis, {-500}))); }},
      {"stop", [](ScriptedBus& bus) { return done(bus.run(verbs::stop(axis))); }},
      {"position", [](ScriptedBus& bus) { return place(bus.run(verbs::position(axis))); }},
      {"state",
       [](ScriptedBus& bus) {
         return show(bus.run(verbs::state(axis)), [](const AxisState& state) {
           return std::to_string(state.position.value) + " " +
                  std::to_string(state.velocity.value) + " " + std::to_string(state.target.value);
         });
       }},
      {"wait_until_reached",
       [](ScriptedBus& bus) {
         bus.module(1).parameter(axis.motor, axis_parameter::actual_velocity) = 0;
         return place(bus.run(verbs::wait_until_reached(axis)));
       }},
      {"wait_until_reached for a goal",
       [](ScriptedBus& bus) {
         bus.module(1).parameter(axis.motor, axis_parameter::actual_velocity) = 0;
         const Microsteps goal{
             bus.module(1).parameter(axis.motor, axis_parameter::target_position)};
         return place(bus.run(verbs::wait_until_reached(axis, {.goal = goal})));
       }},
      {"read_at_rest",
       [](ScriptedBus& bus) {
         bus.module(1).parameter(axis.motor, axis_parameter::actual_velocity) = 0;
         bus.module(1).parameter(axis.motor, axis_parameter::position_reached) = 1;
         RestReadings wanted;
         wanted.parameter = axis_parameter::actual_position;
         wanted.most = 2;
         return show(bus.run(verbs::read_at_rest(axis, wanted)),
                     [](const std::vector<ReadingAt>& readings) {
                       return std::to_string(readings.back().value);
                     });
       }},
      {"store", [](ScriptedBus& bus) { return done(bus.run(verbs::store(axis, 4))); }},
      {"restore", [](ScriptedBus& bus) { return done(bus.run(verbs::restore(axis, 4))); }},
      {"parameter_range",
       [](ScriptedBus& bus) {
         return show(bus.run(verbs::parameter_range(axis, 4)), [](const ParameterRange& range) {
           return std::to_string(range.least) + ".." + std::to_string(range.greatest);
         });
       }},
      {"store_global",
       [](ScriptedBus& bus) { return done(bus.run(verbs::store_global(axis.module, 2, 5))); }},
      {"restore_global",
       [](ScriptedBus& bus) { return done(bus.run(verbs::restore_global(axis.module, 2, 5))); }},
      {"start_reference_search",
       [](ScriptedBus& bus) { return done(bus.run(verbs::start_reference_search(axis))); }},
      {"stop_reference_search",
       [](ScriptedBus& bus) { return done(bus.run(verbs::stop_reference_search(axis))); }},
      {"home",
       [](ScriptedBus& bus) {
         return show(bus.run(verbs::home(axis, {.mode = 2})), [](const Homed& homed) {
           return std::to_string(homed.correction->value) + " " +
                  std::to_string(homed.switch_distance->value);
         });
       }},
      {"set_coordinate",
       [](ScriptedBus& bus) { return done(bus.run(verbs::set_coordinate(axis, 3, {-77}))); }},
      {"coordinate", [](ScriptedBus& bus) { return place(bus.run(verbs::coordinate(axis, 3))); }},
      {"capture_coordinate",
       [](ScriptedBus& bus) { return place(bus.run(verbs::capture_coordinate(axis, 3))); }},
      {"store_coordinates",
       [](ScriptedBus& bus) { return done(bus.run(verbs::store_coordinates(axis.module))); }},
      {"load_coordinates",
       [](ScriptedBus& bus) { return done(bus.run(verbs::load_coordinates(axis.module, 3))); }},
      {"move_to_coordinate",
       [](ScriptedBus& bus) { return done(bus.run(verbs::move_to_coordinate(axis, 3))); }},
      {"move_motors_to_coordinate",
       [](ScriptedBus& bus) {
         return done(bus.run(
             verbs::move_motors_to_coordinate(axis.module, {0b110}, Together::interpolated, 3)));
       }},
      {"get_io",
       [](ScriptedBus& bus) {
         return count(bus.run(verbs::get_io(axis.module, IoBank::analog_inputs, 1)));
       }},
      {"set_output",
       [](ScriptedBus& bus) { return done(bus.run(verbs::set_output(axis.module, 1, 1))); }},
      {"firmware_info",
       [](ScriptedBus& bus) {
         return show(bus.run(verbs::firmware_info(axis.module)), [](const FirmwareInfo& info) {
           return std::to_string(*info.module_id) + " " + std::to_string(*info.capabilities);
         });
       }},
      {"request_arrival_events",
       [](ScriptedBus& bus) {
         return done(
             bus.run(verbs::request_arrival_events(axis.module, ArrivalEvents::every_move, 7)));
       }},
      {"read_program",
       [](ScriptedBus& bus) {
         bus.module(1).program() = {{Command::MVP, 0, 1, 7}, {Command::STOP, 0, 0, 0}};
         return show(bus.run(verbs::read_program(axis.module, {.length = 3})),
                     [](const program::Program& program) {
                       return std::to_string(program.size()) + " " +
                              std::to_string(program.front().value);
                     });
       }},
      {"run_program",
       [](ScriptedBus& bus) { return done(bus.run(verbs::run_program(axis.module, 5))); }},
      {"stop_program",
       [](ScriptedBus& bus) { return done(bus.run(verbs::stop_program(axis.module))); }},
      {"program_status",
       [](ScriptedBus& bus) {
         return show(bus.run(verbs::program_status(axis.module)), [](const ProgramStatus& status) {
           return std::to_string(*status.next_address) + " " + std::to_string(*status.last_error);
         });
       }},
      {"add_breakpoint",
       [](ScriptedBus& bus) { return done(bus.run(verbs::add_breakpoint(axis.module, 5))); }},
      {"reset_module",
       [](ScriptedBus& bus) { return done(bus.run(verbs::reset_module(axis.module))); }},
      {"data_logger_info",
       [](ScriptedBus& bus) {
         test::give_data_logger(bus.module(1), bus.clock());
         return show(bus.run(verbs::data_logger_info(axis.module)), [](const DataLoggerInfo& info) {
           return std::to_string(info.channels) + " " + std::to_string(info.elements);
         });
       }},
      {"start_capture",
       [](ScriptedBus& bus) {
         test::give_data_logger(bus.module(1), bus.clock());
         return done(bus.run(verbs::start_capture(axis.module, short_capture())));
       }},
      {"read_samples",
       [](ScriptedBus& bus) {
         test::give_data_logger(bus.module(1), bus.clock());
         if (const auto begun = bus.run(verbs::start_capture(axis.module, short_capture())); !begun)
           return text_of(begun.error());
         bus.pass(std::chrono::milliseconds(10));
         return show(bus.run(verbs::read_samples(axis.module, 0, 4)), [](const auto& values) {
           return std::to_string(values.size()) +
                  " from the same tick: " + std::to_string(values[1] - values[0]);
         });
       }},
      {"end_capture",
       [](ScriptedBus& bus) {
         test::give_data_logger(bus.module(1), bus.clock());
         return done(bus.run(verbs::end_capture(axis.module)));
       }},
      {"identify",
       [](ScriptedBus& bus) {
         return show(bus.run(verbs::identify(axis.module)), [](const FoundModule& found) {
           return std::string(found.model) + " " + to_string(found.version);
         });
       }},
      {"scan",
       [](ScriptedBus& bus) {
         return show(bus.run(verbs::scan({.first = 1, .last = 3})),
                     [](const std::vector<FoundModule>& found) {
                       std::string text;
                       for (const auto& module : found)
                         text += std::to_string(number(module.address)) + " ";
                       return text;
                     });
       }},
  };
}

std::size_t count_movements(const std::vector<Request>& requests) {
  return static_cast<std::size_t>(std::ranges::count_if(requests, [](const Request& request) {
    return effect_of(request.command, request.type) == Effect::moves;
  }));
}

class EveryStepFails : public testing::TestWithParam<Framing> {};

TEST_P(EveryStepFails, NoVerbGivesAWrongAnswerOrMovesTwice) {
  for (const auto& verb : all_verbs()) {
    ScriptedBus healthy(GetParam());
    healthy.add_module(1);
    const auto expected = verb.run(healthy);
    ASSERT_FALSE(expected.starts_with("error")) << verb.name;
    for (std::size_t datagram = 0; datagram < healthy.sent().size(); ++datagram) {
      for (const auto fault : test::all_faults) {
        SCOPED_TRACE(verb.name + ", datagram " + std::to_string(datagram) + ", " +
                     test::name_of(fault));
        ScriptedBus bus(GetParam());
        bus.add_module(1);
        bus.fail(datagram, fault);
        const auto result = verb.run(bus);
        // A scan asks once: a module whose answer got lost is missing from it.
        const bool is_empty_scan = verb.name == "scan" && result.empty();
        EXPECT_TRUE(result == expected || result.starts_with("error") || is_empty_scan) << result;
        EXPECT_LE(count_movements(bus.sent()), 1U);
        EXPECT_LE(bus.clock().now(), TimePoint{} + std::chrono::seconds(2));
        // One fault costs one verb: the next one is answered, and rightly.
        EXPECT_EQ(count(bus.run(verbs::get(axis, 5))),
                  std::to_string(bus.module(1).parameter(axis.motor, 5)));
      }
    }
  }
}

TEST_P(EveryStepFails, ReadsAndStopsSurviveAnySingleFault) {
  const std::set<std::string> sturdy{"get",
                                     "set",
                                     "get_global",
                                     "stop",
                                     "position",
                                     "state",
                                     "wait_until_reached",
                                     "wait_until_reached for a goal",
                                     "parameter_range",
                                     "stop_reference_search",
                                     "coordinate",
                                     "load_coordinates",
                                     "get_io",
                                     "firmware_info"};
  for (const auto& verb : all_verbs()) {
    if (!sturdy.contains(verb.name)) continue;
    for (const auto fault : test::all_faults) {
      SCOPED_TRACE(verb.name + ", " + test::name_of(fault));
      ScriptedBus healthy(GetParam());
      healthy.add_module(1);
      ScriptedBus bus(GetParam());
      bus.add_module(1);
      bus.fail(0, fault);
      EXPECT_EQ(verb.run(bus), verb.run(healthy));
    }
  }
}

TEST_P(EveryStepFails, AMovementWithoutAnswerEndsAsUnknown) {
  for (const auto fault :
       {Fault::lost_request, Fault::lost_reply, Fault::bad_checksum, Fault::late_reply}) {
    ScriptedBus bus(GetParam());
    bus.add_module(1);
    bus.fail(0, fault);
    const auto result = bus.run(verbs::move_to(axis, {51200}));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().outcome, Outcome::unknown);
    EXPECT_EQ(result.error().code, Errc::reply_timeout);
    EXPECT_EQ(result.error().bus, "bench");
    EXPECT_FALSE(result.error().hint.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Links, EveryStepFails, testing::Values(Framing::serial, Framing::can),
                         [](const auto& parameter) {
                           return parameter.param == Framing::serial ? "serial" : "can";
                         });

TEST(Verbs, MoveByNeverSendsARelativeMove) {
  ScriptedBus bus;
  bus.add_module(1).parameter(axis.motor, axis_parameter::actual_position) = 700;
  const auto target = bus.run(verbs::move_by(axis, {-1000}));
  ASSERT_TRUE(target);
  EXPECT_EQ(*target, Microsteps{-300});
  // Where it goes is computed from a position that was read twice, with another read between.
  EXPECT_THAT(commands_of(bus.sent()),
              ElementsAre(Command::GAP, Command::GET_FIRMWARE_VERSION, Command::GAP, Command::MVP));
  EXPECT_EQ(bus.sent().back(), (Request{axis.module, Command::MVP, 0, axis.motor, -300}));
}

TEST(Verbs, MoveByBeyondEveryPositionIsRefusedUnsent) {
  ScriptedBus bus;
  bus.add_module(1).parameter(axis.motor, axis_parameter::actual_position) = 1;
  const auto target = bus.run(verbs::move_by(axis, {INT32_MAX}));
  ASSERT_FALSE(target);
  EXPECT_EQ(target.error().code, Errc::bad_argument);
  EXPECT_EQ(count_movements(bus.sent()), 0U);
}

TEST(Verbs, SetReadsBackWhenTheAnswerIsLost) {
  for (const auto fault : {Fault::lost_request, Fault::lost_reply}) {
    ScriptedBus bus;
    bus.add_module(1);
    bus.fail(0, fault);
    ASSERT_TRUE(bus.run(verbs::set(axis, 4, 77)));
    EXPECT_EQ(bus.module(1).parameter(axis.motor, 4), 77);
    const auto writes =
        std::ranges::count(bus.module(1).executed(), Command::SAP, &Request::command);
    EXPECT_EQ(writes, 1) << test::name_of(fault);
  }
}

TEST(Verbs, ARefusalSaysWhy) {
  ScriptedBus bus;
  bus.add_module(1, 1);
  const auto value = bus.run(verbs::get({ModuleAddress{1}, 5}, 4));
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().outcome, Outcome::refused);
  EXPECT_EQ(value.error().status, Status::invalid_value);
  EXPECT_THAT(describe(value.error()), testing::HasSubstr("GAP 4 0 for motor 5 of module 1"));
}

TEST(Verbs, WaitingEndsWhenTheAxisStandsShortOfItsTarget) {
  ScriptedBus bus;
  auto& module = bus.add_module(1);
  module.parameter(axis.motor, axis_parameter::actual_velocity) = 0;
  module.parameter(axis.motor, axis_parameter::position_reached) = 0;
  module.parameter(axis.motor, axis_parameter::actual_position) = 90;
  module.parameter(axis.motor, axis_parameter::target_position) = 100;
  const auto result = bus.run(verbs::wait_until_reached(axis));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::move_interrupted);
  EXPECT_THAT(result.error().message, testing::HasSubstr("10 microsteps short of its target 100"));
}

TEST(Verbs, WaitingGivesTheTargetWheneverTheAxisArrives) {
  // The axis arrives just before the n-th request.
  for (std::size_t n = 1; n < 12; ++n) {
    ScriptedBus bus;
    auto& module = bus.add_module(1);
    module.parameter(axis.motor, axis_parameter::position_reached) = 0;
    module.parameter(axis.motor, axis_parameter::actual_position) = 90;
    module.parameter(axis.motor, axis_parameter::target_position) = 100;
    module.before = [n](test::FakeModule& self, const Request&) {
      if (self.executed().size() < n) return;
      self.parameter(axis.motor, axis_parameter::position_reached) = 1;
      self.parameter(axis.motor, axis_parameter::actual_position) = 100;
      self.parameter(axis.motor, axis_parameter::actual_velocity) = 0;
    };
    EXPECT_EQ(bus.run(verbs::wait_until_reached(axis)), Microsteps{100}) << n;
  }
}

/// An axis that is sent to 100, on its way; its module says by 138 whether it turns by velocity.
class WaitForGoal : public testing::Test {
 protected:
  static constexpr std::uint8_t ramp_mode = 138;
  static constexpr ModeParameter turning{ramp_mode, 2};

  WaitForGoal() {
    set(axis_parameter::position_reached, 0);
    set(axis_parameter::actual_velocity, 50);
    set(axis_parameter::actual_position, 90);
    set(axis_parameter::target_position, 100);
    set(ramp_mode, 0);
  }
  void set(std::uint8_t parameter, std::int32_t value) {
    module.parameter(axis.motor, parameter) = value;
  }
  /// Before anything that is asked from then on.
  void change_after(Duration passed, std::function<void()> change) {
    module.before = [=, this](test::FakeModule&, const Request&) {
      if (bus.clock().now() >= TimePoint{} + passed) change();
    };
  }
  Result<Microsteps> wait() {
    return bus.run(verbs::wait_until_reached(
        axis, {.expected = std::chrono::hours(1), .goal = Microsteps{100}, .mode = turning}));
  }
  void expect_interrupted(std::string_view why, Duration at_most) {
    const auto result = wait();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::move_interrupted);
    EXPECT_THAT(result.error().message, testing::HasSubstr(std::string(why)));
    EXPECT_LE(bus.clock().now() - TimePoint{}, at_most);
  }

  ScriptedBus bus;
  test::FakeModule& module = bus.add_module(1);
};

TEST_F(WaitForGoal, EndsWhereTheAxisStandsThen) {
  change_after(std::chrono::seconds(5), [this] {
    set(axis_parameter::position_reached, 1);
    set(axis_parameter::actual_velocity, 0);
    set(axis_parameter::actual_position, 100);
  });
  EXPECT_EQ(wait(), Microsteps{100});
}

TEST_F(WaitForGoal, EndsWhenTheAxisIsSentElsewhere) {
  change_after(std::chrono::seconds(5), [this] { set(axis_parameter::target_position, 500); });
  expect_interrupted("was sent to 500 instead, at 90, 10 microsteps short of its target 100",
                     std::chrono::milliseconds(6500));
}

TEST_F(WaitForGoal, EndsWhenTheAxisStandsAtAnotherTarget) {
  change_after(std::chrono::seconds(5), [this] {
    set(axis_parameter::position_reached, 1);
    set(axis_parameter::actual_velocity, 0);
    set(axis_parameter::target_position, 90);
  });
  expect_interrupted("was sent to 90 instead", std::chrono::milliseconds(6500));
}

TEST_F(WaitForGoal, EndsWhenTheAxisTurnsByVelocity) {
  change_after(std::chrono::seconds(5), [this] { set(ramp_mode, 2); });
  expect_interrupted("was stopped, or turned by velocity, at 90", std::chrono::milliseconds(6500));
}

TEST_F(WaitForGoal, AsksForTheModeTwiceASecondAtMost) {
  // Near the end of the move it is looked at often.
  change_after(std::chrono::seconds(3), [this] { set(axis_parameter::target_position, 500); });
  const auto result =
      bus.run(verbs::wait_until_reached(axis, {.goal = Microsteps{100}, .mode = turning}));
  ASSERT_FALSE(result);
  const auto asked = std::ranges::count(module.executed(), ramp_mode, &Request::type);
  EXPECT_GE(asked, 5);
  EXPECT_LE(asked, 6);
}

// Once a second as long as nothing can be expected, and often from shortly before.
TEST(Verbs, WaitingSparesTheBusUntilTheMoveShouldEnd) {
  ScriptedBus bus;
  auto& module = bus.add_module(1);
  module.parameter(axis.motor, axis_parameter::position_reached) = 0;
  const auto begin = bus.clock().now();
  std::vector<double> looks;
  module.before = [&](test::FakeModule& self, const Request& request) {
    const auto passed = std::chrono::duration<double>(bus.clock().now() - begin).count();
    if (request.type == axis_parameter::position_reached) looks.push_back(passed);
    if (passed < 3.5) return;
    self.parameter(axis.motor, axis_parameter::position_reached) = 1;
    self.parameter(axis.motor, axis_parameter::actual_velocity) = 0;
  };
  EXPECT_TRUE(
      bus.run(verbs::wait_until_reached(axis, {.expected = std::chrono::milliseconds(3500)})));
  EXPECT_LE(std::ranges::count_if(looks, [](double at) { return at < 3.4; }), 4);
  EXPECT_LT(looks.back(), 3.55);
}

/// An axis on its way, on a bus whose modules take their time.
class SlowWait : public testing::TestWithParam<std::tuple<Framing, std::chrono::milliseconds>> {
 protected:
  SlowWait() : bus(std::get<0>(GetParam()), {.name = "bench", .reply_timeout = patience}) {
    bus.answer_time = exchange;
    auto& module = bus.add_module(1);
    module.parameter(axis.motor, axis_parameter::position_reached) = 0;
    module.before = [this](test::FakeModule& self, const Request&) {
      if (bus.clock().now() < TimePoint{} + arrival) return;
      self.parameter(axis.motor, axis_parameter::position_reached) = 1;
      self.parameter(axis.motor, axis_parameter::actual_velocity) = 0;
    };
  }
  Result<Microsteps> wait(WaitOptions options = {}) {
    options.timeout = timeout;
    return bus.run(verbs::wait_until_reached(axis, options));
  }
  Duration passed() { return bus.clock().now() - TimePoint{}; }

  static constexpr Duration patience = std::chrono::milliseconds(500);
  Duration timeout = std::chrono::seconds(1);
  const Duration exchange = std::get<1>(GetParam());
  Duration arrival = std::chrono::hours(1);
  ScriptedBus bus;
};

TEST_P(SlowWait, EndsAtItsTimeoutHoweverLongTheLooksTake) {
  arrival = timeout + exchange + std::chrono::milliseconds(1);
  for (const Duration expected : {Duration{}, Duration(std::chrono::hours(1))}) {
    const auto begin = passed();
    const auto result = wait({.expected = expected});
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::deadline_passed);
    const bool was_seen = 4 * exchange <= timeout;  // in one whole look
    EXPECT_THAT(result.error().message,
                testing::HasSubstr(was_seen ? "has not arrived yet" : "there was no time to see"));
    EXPECT_GE(passed() - begin, timeout);
    EXPECT_LE(passed() - begin, timeout + exchange);
    arrival += passed();
  }
}

TEST_P(SlowWait, SeesAnArrivalInTimeHoweverLongTheLooksTake) {
  // There may be the rest of a look that began before; one whole one is needed, and one that is
  // proven.
  const auto looks = 2 * (4 * exchange + WaitOptions{}.poll_interval) + 5 * exchange;
  arrival = timeout;
  timeout += looks;
  EXPECT_TRUE(wait());
  EXPECT_GE(passed(), arrival);
  EXPECT_LE(passed(), timeout + exchange);
}

TEST_P(SlowWait, EndsAtItsTimeoutWhereTheModuleFallsSilent) {
  const auto last = timeout - std::chrono::milliseconds(50);
  bus.chance = [this, last](std::size_t) {
    return passed() >= last ? std::optional(Fault::lost_request) : std::nullopt;
  };
  const auto result = wait();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::deadline_passed);
  EXPECT_LE(passed(), timeout + patience) << "not tried a second time";
}

TEST_P(SlowWait, NoticesAnInterruptionHoweverLongTheLooksTake) {
  bus.module(1).parameter(axis.motor, axis_parameter::actual_velocity) = 0;
  const auto result = bus.run(verbs::wait_until_reached(axis));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::move_interrupted);
  const auto look = 4 * exchange + WaitOptions{}.poll_interval;
  EXPECT_GE(passed(), WaitOptions{}.standstill_limit);
  EXPECT_LE(passed(), WaitOptions{}.standstill_limit + 2 * look) << "the first, and the last";
}

INSTANTIATE_TEST_SUITE_P(
    Links, SlowWait,
    testing::Combine(testing::Values(Framing::serial, Framing::can),
                     testing::Values(std::chrono::milliseconds(1), std::chrono::milliseconds(81),
                                     std::chrono::milliseconds(100),
                                     std::chrono::milliseconds(400))),
    [](const auto& parameter) {
      return std::string(std::get<0>(parameter.param) == Framing::serial ? "serial" : "can") +
             std::to_string(std::get<1>(parameter.param).count()) + "ms";
    });

TEST(Verbs, AWaitForWhichThereIsNoTimeSaysSo) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.answer_time = std::chrono::milliseconds(10);
  const auto result =
      bus.run(verbs::wait_until_reached(axis, {.timeout = std::chrono::milliseconds(1)}));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::deadline_passed);
  EXPECT_EQ(result.error().message,
            "there was no time to see whether motor 2 of module 1 has arrived");
  EXPECT_EQ(bus.sent().size(), 1U);
}

// ---- another program that asks on the same bus

/// An answer to somebody else's question, as it is heard here.
void answer_another(ScriptedBus& bus, std::int32_t value) {
  bus.deliver({default_host_address, 1, Status::ok, Command::GAP, value});
}

/// Somebody else's answers have been heard here, and go on coming: at every `period`-th request of
/// ours, one that says `value`.
void share_with_another(ScriptedBus& bus, std::size_t period, std::int32_t value) {
  ASSERT_TRUE(bus.run(verbs::get(axis, 4)));
  for (int i = 0; i < 3; ++i) answer_another(bus, 0);
  bus.chance = [&bus, period, value](std::size_t number) -> std::optional<Fault> {
    if (number % period == 0) answer_another(bus, value);
    return std::nullopt;
  };
}

constexpr std::int32_t foreign = 100'000;
// A reading and its proof are two requests: where a foreign answer comes with one of them each
// time, nobody can know anything.
constexpr std::size_t hopeless = 2;

TEST(SharedBus, MoveByNeverGoesToWhereAForeignAnswerLeads) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    for (std::size_t period = 1; period <= 5; ++period) {
      ScriptedBus bus(framing);
      auto& here = bus.add_module(1).parameter(axis.motor, axis_parameter::actual_position);
      here = 0;
      share_with_another(bus, period, foreign);
      for (int i = 0; i < 30; ++i) {
        const auto before = here;
        const auto moved = bus.run(verbs::move_by(axis, {10}));
        if (moved) {
          EXPECT_EQ(here, before + 10);
        } else {
          EXPECT_EQ(here, before);
          EXPECT_EQ(moved.error().outcome, Outcome::not_sent);
          EXPECT_THAT(describe(moved.error()), testing::HasSubstr("another program asks"));
        }
        EXPECT_EQ(moved.has_value(), period > hopeless) << period;
      }
    }
  }
}

TEST(SharedBus, WaitingTellsNoForgedArrival) {
  for (std::size_t period = 1; period <= 6; ++period) {
    SCOPED_TRACE(period);
    ScriptedBus bus(Framing::can);
    auto& module = bus.add_module(1);
    module.parameter(axis.motor, axis_parameter::position_reached) = 0;
    module.parameter(axis.motor, axis_parameter::actual_position) = 90;
    module.parameter(axis.motor, axis_parameter::target_position) = 5000;
    module.parameter(axis.motor, axis_parameter::actual_velocity) = 0;
    share_with_another(bus, period, 1);
    const auto begin = bus.clock().now();
    module.before = [&](test::FakeModule& self, const Request&) {
      auto& at = self.parameter(axis.motor, axis_parameter::actual_position);
      if (bus.clock().now() - begin < std::chrono::seconds(1)) {
        ++at;
        return;
      }
      at = 5000;
      self.parameter(axis.motor, axis_parameter::position_reached) = 1;
    };
    const auto arrived =
        bus.run(verbs::wait_until_reached(axis, {.timeout = std::chrono::seconds(10)}));
    if (period <= hopeless) {
      ASSERT_FALSE(arrived);
      EXPECT_EQ(arrived.error().code, Errc::unexpected_value);
    } else {
      EXPECT_EQ(arrived, Microsteps{5000});
      EXPECT_GE(bus.clock().now() - begin, std::chrono::seconds(1));
    }
  }
}

TEST(SharedBus, AScanStillFindsTheModules) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  share_with_another(bus, 1, foreign);
  const auto found = bus.run(verbs::scan({.first = 1, .last = 3}));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->at(0).model, "TMCM-3110");
  EXPECT_TRUE(found->at(0).duplicate_suspected);
}

TEST(Verbs, WaitingThatEndsWithTheLinkSaysThatTheAxisGoesOn) {
  for (const bool in_flight : {false, true}) {
    ScriptedBus bus;
    bus.add_module(1).parameter(axis.motor, axis_parameter::position_reached) = 0;
    auto script = verbs::wait_until_reached(axis);
    auto step = script.start(bus.clock().now());
    for (int i = 0; i < 4; ++i) step = script.resume(bus.perform(*step), bus.clock().now());
    if (!in_flight) bus.engine().on_link_lost("the cable is gone");
    if (in_flight) {
      bus.chance = [&](std::size_t) -> std::optional<Fault> {
        bus.engine().on_link_lost("the cable is gone");
        return Fault::lost_request;
      };
    }
    while (step) step = script.resume(bus.perform(*step), bus.clock().now());
    const auto result = script.take();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::link_lost);
    EXPECT_EQ(result.error().outcome, Outcome::unknown);
    EXPECT_THAT(describe(result.error()), testing::HasSubstr("the cable is gone"));
    EXPECT_THAT(describe(result.error()), testing::HasSubstr("goes on"));
  }
}

TEST(Verbs, MoveByWithoutAReadingWasNotSent) {
  ScriptedBus bus;
  const auto moved = bus.run(verbs::move_by(axis, {10}));
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, Errc::module_silent);
  EXPECT_EQ(moved.error().outcome, Outcome::not_sent);
}

TEST(Verbs, ScanFindsAddressModelFirmwareAndAxes) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    bus.add_module(7);
    bus.add_module(200);
    const auto found = bus.run(verbs::scan());
    ASSERT_TRUE(found);
    ASSERT_EQ(found->size(), 2U);
    EXPECT_EQ(found->at(0).address, ModuleAddress{7});
    EXPECT_EQ(found->at(1).address, ModuleAddress{200});
    EXPECT_EQ(found->at(0).model, "TMCM-3110");
    EXPECT_EQ(to_string(found->at(0).version), "1.09");
    EXPECT_EQ(found->at(0).axes, 3);
    EXPECT_FALSE(found->at(0).duplicate_suspected);
    // Again, although most addresses did not answer the first time.
    const auto again = bus.run(verbs::scan());
    ASSERT_TRUE(again);
    EXPECT_EQ(again->size(), 2U);
  }
}

}  // namespace
}  // namespace tmcl
