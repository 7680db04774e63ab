// Speed, acceleration and current of an axis stay within what the configuration says, whoever asks.
#include "gateway/authority/axis_limits.hpp"

#include <gmock/gmock.h>

#include "unit/journey_bench.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;

// A TMCM-3110 with dividers of 3: its velocities count in 30.5 microsteps/s, its accelerations in
// 7451 microsteps/s^2.
constexpr auto within = R"(max_velocity = 30518
max_acceleration = 3800000
max_current = 100
)";

class AxisWithLimits : public testing::Test {
 protected:
  explicit AxisWithLimits(const std::string& axes = axis_section("x", 0, within) +
                                                    axis_section("y", 1))
      : bench(std::string(bench_bus) + axes) {
    auto& module = bench.wire.modules.at(1);
    for (const auto& [number, value] : std::map<int, int>{{4, 1000},
                                                          {5, 500},
                                                          {6, 100},
                                                          {7, 10},
                                                          {138, 0},
                                                          {140, 8},
                                                          {153, 3},
                                                          {154, 3},
                                                          {194, 500},
                                                          {195, 100},
                                                          {200, 0}})
      for (const auto motor : {std::uint8_t{0}, std::uint8_t{1}})
        module.parameter(motor, static_cast<std::uint8_t>(number)) = value;
  }
  Result<boost::json::object> execute(std::string_view command, int type, int value) {
    return bench.call("module.execute", {{"bus", "bench"},
                                         {"address", 1},
                                         {"command", command},
                                         {"type", type},
                                         {"motor", 0},
                                         {"value", value}});
  }
  Result<boost::json::object> set(const char* parameter, int value, const char* axis = "x") {
    return bench.call("parameter.set",
                      {{"axis", axis}, {"parameter", parameter}, {"value", value}});
  }
  static std::string name(const Result<boost::json::object>& result) {
    return result ? "" : result.error().name;
  }
  std::int32_t held(std::uint8_t parameter) {
    return bench.wire.modules.at(1).parameter(0, parameter);
  }

  VirtualGateway bench;
};

TEST_F(AxisWithLimits, IsNotSetBeyondThem) {
  const auto refused = set("max_velocity", 1001);
  EXPECT_EQ(name(refused), "not_permitted");
  EXPECT_EQ(refused.error().kind, ErrorKind::not_now);
  EXPECT_EQ(refused.error().outcome, tmcl::Outcome::not_sent);
  EXPECT_EQ(refused.error().message,
            "axis 'x': max_velocity would be 30548.1 microsteps/s, above its limit of 30518 "
            "microsteps/s");
  EXPECT_EQ(refused.error().hint, "the configuration has it: 'max_velocity'");
  EXPECT_EQ(name(set("max_acceleration", 2000)), "not_permitted");
  EXPECT_EQ(name(set("max_current", 101)), "not_permitted");
  EXPECT_EQ(name(set("standby_current", 101)), "not_permitted");
  EXPECT_EQ(name(set("reference_search_speed", 1001)), "not_permitted");
  EXPECT_EQ(name(execute("SAP", 4, 1001)), "not_permitted");
  EXPECT_EQ(name(execute("SAP", 2, -1001)), "not_permitted");
  EXPECT_EQ(bench.wire.count(Command::SAP), 0U);
}

/// A sixPoint module, whose accelerations are in microsteps a second squared.
class LimitedBraking : public testing::Test {
 protected:
  explicit LimitedBraking(const char* limits = "max_acceleration = 5000\nmax_deceleration = 2000\n")
      : bench("TMCM-6212", limits) {
    // As it is after it was switched on it would be beyond.
    for (const auto* name :
         {"max_acceleration", "acceleration_a1", "deceleration_d1", "max_deceleration"})
      EXPECT_EQ(set(name, 1000), "") << name;
  }
  std::string set(const char* parameter, int value) {
    const auto result =
        bench.call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
    return result ? "" : result.error().hint;
  }

  JourneyBench bench;
};

TEST_F(LimitedBraking, HasALimitOfItsOwn) {
  EXPECT_EQ(set("acceleration_a1", 5000), "");
  EXPECT_EQ(set("acceleration_a1", 5001), "the configuration has it: 'max_acceleration'");
  for (const auto* name : {"max_deceleration", "deceleration_d1"}) {
    EXPECT_EQ(set(name, 2000), "");
    EXPECT_EQ(set(name, 2001), "the configuration has it: 'max_deceleration'");
  }
  // By which it brakes, too, when it turns.
  EXPECT_EQ(set("max_acceleration", 2000), "");
  EXPECT_EQ(set("max_acceleration", 2001), "the configuration has it: 'max_deceleration'");
}

class OneLimitForBoth : public LimitedBraking {
 protected:
  OneLimitForBoth() : LimitedBraking("max_acceleration = 5000\n") {}
};

TEST_F(OneLimitForBoth, IsThatOfTheAcceleration) {
  EXPECT_EQ(set("max_deceleration", 5000), "");
  EXPECT_EQ(set("max_deceleration", 5001), "the configuration has it: 'max_acceleration'");
}

/// A TMC457, whose bow of 11 is 931,322,575 microsteps a second cubed: each more is twice as much.
class LimitedJerk : public testing::Test {
 protected:
  Result<boost::json::object> set_bow(int bow) {
    return bench.call("parameter.set", {{"axis", "x"}, {"parameter", "max_bow"}, {"value", bow}});
  }
  Result<boost::json::object> move_to(int position) {
    return bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", position}});
  }

  JourneyBench bench{"TMCM-142", "max_jerk = 1e9\n"};
};

TEST_F(LimitedJerk, IsThatOfTheBow) {
  EXPECT_TRUE(set_bow(11));
  const auto refused = set_bow(12);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "axis 'x': max_bow would be 1862645149 microsteps/s^3, above its limit of 1000000000 "
            "microsteps/s^3");
  EXPECT_EQ(refused.error().hint, "the configuration has it: 'max_jerk'");
  EXPECT_FALSE(set_bow(0)) << "an acceleration that changes at once";
  EXPECT_TRUE(move_to(1000));
}

TEST_F(LimitedJerk, LetsNoLineOrPathDoWithoutItsBow) {
  const auto refused = bench.call(
      "line.move",
      {{"axes", boost::json::array{"x"}}, {"positions_microsteps", boost::json::array{1000}}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("above its limit of 1000000000 microsteps/s^3"));
}

TEST(LimitedJerkWithoutSCurves, LetsNothingMoveTheAxis) {
  JourneyBench bench("TMCM-6212", "max_jerk = 1e9\n");
  const auto refused = bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1000}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("its module makes no S-curves"));
  EXPECT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
}

TEST_F(AxisWithLimits, IsSetUpToThem) {
  EXPECT_EQ(name(set("max_velocity", 900)), "");
  EXPECT_EQ(name(set("max_velocity", 1000)), "");
  EXPECT_EQ(name(execute("SAP", 6, 100)), "");
  EXPECT_EQ(held(4), 1000);
  EXPECT_EQ(name(set("max_velocity", 2047, "y")), "");
}

TEST_F(AxisWithLimits, IsNotScaledBeyondThem) {
  EXPECT_EQ(name(set("pulse_divisor", 2)), "not_permitted");
  EXPECT_EQ(name(set("ramp_divisor", 0)), "not_permitted");
  EXPECT_EQ(name(set("pulse_divisor", 4)), "");
  EXPECT_EQ(name(set("max_velocity", 1500)), "");
  EXPECT_EQ(name(set("pulse_divisor", 3)), "not_permitted");
}

TEST_F(AxisWithLimits, DoesNotTurnFaster) {
  for (const auto* command : {"ROR", "ROL"}) {
    const auto refused = execute(command, 0, 1001);
    EXPECT_EQ(name(refused), "not_permitted");
    EXPECT_THAT(refused.error().message, HasSubstr("it would turn at 30548.1 microsteps/s"));
  }
  EXPECT_EQ(name(bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", -1001}})),
            "not_permitted");
  EXPECT_EQ(bench.wire.count(Command::ROR) + bench.wire.count(Command::ROL), 0U);
  EXPECT_EQ(name(execute("ROR", 0, 1000)), "");
}

TEST_F(AxisWithLimits, DoesNotMoveWhileASettingIsBeyondThem) {
  bench.wire.modules.at(1).parameter(0, 4) = 1200;
  for (const auto& [method, params] : std::vector<std::pair<std::string, json::object>>{
           {"axis.move_to", {{"axis", "x"}, {"position_microsteps", 9}}},
           {"axis.move_by", {{"axis", "x"}, {"distance_microsteps", 9}}},
           {"axis.start_home", {{"axis", "x"}}},
           {"coordinate.start",
            {{"bus", "bench"}, {"address", 1}, {"number", 1}, {"motors", json::array{0, 1}}}}}) {
    const auto refused = bench.call(method, params);
    EXPECT_EQ(name(refused), "not_permitted") << method;
    EXPECT_THAT(refused.error().message, HasSubstr("nothing moves it while its max_velocity is"));
    EXPECT_THAT(refused.error().hint, HasSubstr("tmclctl set x max_velocity"));
  }
  EXPECT_EQ(name(execute("MVP", 0, 9)), "not_permitted");
  EXPECT_EQ(bench.wire.count(Command::MVP) + bench.wire.count(Command::RFS), 0U);
  EXPECT_EQ(name(set("max_velocity", 1000)), "");
  EXPECT_EQ(name(execute("MVP", 0, 9)), "");
}

TEST_F(AxisWithLimits, StopsInAnyCase) {
  bench.wire.modules.at(1).parameter(0, 4) = 1200;
  EXPECT_EQ(name(bench.call("axis.stop", {{"axis", "x"}})), "");
  EXPECT_EQ(name(execute("ROR", 0, 0)), "");
}

TEST_F(AxisWithLimits, IsNotGivenWhatNobodySees) {
  EXPECT_EQ(name(execute("RSAP", 4, 0)), "not_permitted");
  EXPECT_EQ(name(execute("AAP", 4, 0)), "not_permitted");
  EXPECT_EQ(name(execute("WRITE_MC", 4, 0)), "not_permitted");
  EXPECT_EQ(name(execute("RSAP", 8, 0)), "");
}

class SecondAxisWithLimits : public AxisWithLimits {
 protected:
  SecondAxisWithLimits() : AxisWithLimits(axis_section("x", 0) + axis_section("y", 1, within)) {}
};

// Its ramp generator has the registers of three motors.
TEST_F(SecondAxisWithLimits, IsNotGivenARegisterOfItsChip) {
  EXPECT_EQ(name(execute("WRITE_MC", 4, 0)), "not_permitted");
}

TEST_F(AxisWithLimits, IsNotGivenWhatNoDocumentNames) {
  EXPECT_EQ(name(execute("77", 0, 0)), "not_permitted");
  EXPECT_EQ(name(execute("UF2", 0, 0)), "");
}

TEST_F(AxisWithLimits, ReadsItsSettingsOnce) {
  for (int i = 0; i < 3; ++i) set("max_velocity", 900 + i);
  bench.wire.seen.clear();
  set("max_velocity", 950);
  const auto read = std::ranges::count_if(bench.wire.seen, [](const tmcl::Request& request) {
    return request.command == Command::GAP && request.type == 5;
  });
  EXPECT_EQ(read, 0);
}

TEST_F(AxisWithLimits, IsSetBeyondThemByWhoMay) {
  bench.caller.exceeds_limits = true;
  EXPECT_EQ(name(set("max_velocity", 1100)), "");
  EXPECT_EQ(name(execute("ROR", 0, 1100)), "");
  bench.caller.exceeds_limits = false;
  EXPECT_EQ(name(execute("MVP", 0, 9)), "not_permitted");
}

}  // namespace
}  // namespace tmcld::test
