// An axis that is tuned through the gateway: who else may do what meanwhile, what ends it, what is
// left then, and what is stored.
#include <gmock/gmock.h>

#include <cmath>

#include "sim/bench.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/tuning.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int32_t of_full_steps = 256;

std::string config_with(const std::string& of_x) {
  std::string config = cable_config;
  return config.insert(config.find("[[axis]]\nname = \"y\""), of_x);
}

class TunedAxis : public Cable {
 protected:
  /// With narrow bounds few trials are made.
  explicit TunedAxis(const std::string& of_x = "max_velocity = 8\nmax_acceleration = 50\n")
      : Cable(config_with(of_x)) {
    tmcl::sim::StageSettings stage;
    stage.load = 300;
    stage.inertia = 100'000;
    stage.corner_speed = 300;
    stage.torque_follows_current = true;
    stage.encoder = tmcl::sim::EncoderSettings{10'000};
    wire.bench().modules().front()->mount(0, stage);
    for (const auto& [parameter, value] :
         {std::pair{4, 200 * of_full_steps}, {5, 1500 * of_full_steps}})
      EXPECT_TRUE(
          call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}}));
    for (const auto parameter : settings()) before.push_back(get(0, parameter));
  }
  static std::vector<std::uint8_t> settings() {
    return tmcl::tune_parameters(*tmcl::find_model("TMCM-6212"));
  }
  Answer begin_tuning(json::object more = {}) {
    more["axis"] = "x";
    more["max_current"] = 200;
    if (!more.contains("from") && more.count("within") == 0) {
      more["from"] = "-20mm";
      more["to"] = "20mm";
    }
    more.erase("within");
    return begin("axis.tune", std::move(more));
  }
  /// In the midst of its trials.
  Answer tuning_under_way() {
    auto answer = begin_tuning();
    EXPECT_TRUE(time.run_while_not(
        [&] { return get(0, ap::max_velocity) > before_of(4) && moves(); }, 5min));
    return answer;
  }
  std::int32_t before_of(std::uint8_t parameter) const {
    const auto all = settings();
    return before[static_cast<std::size_t>(std::ranges::find(all, parameter) - all.begin())];
  }
  void expect_as_before() {
    EXPECT_FALSE(moves());
    const auto all = settings();
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_EQ(get(0, all[i]), before[i]) << int{all[i]};
    EXPECT_THAT(call("lease.list", {})->at("leases").as_array(), IsEmpty());
  }

  std::vector<std::int32_t> before;
};

TEST_F(TunedAxis, IsMeasuredAndAsItWas) {
  const auto position = get(0, ap::actual_position);
  const auto result = end(begin_tuning());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_GT(result->at("velocity").at("limit").as_double(), 250 * of_full_steps);
  EXPECT_GT(result->at("trials").as_array().size(), 10U);
  EXPECT_EQ(result->at("stored"), false);
  EXPECT_EQ(get(0, ap::actual_position), position);
  expect_as_before();
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 1}}));
}

TEST_F(TunedAxis, HasWhatIsProposedAndKeepsItWhenThatIsAskedFor) {
  const auto result = end(begin_tuning({{"store", true}}));
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->at("stored"), true);
  for (const auto& setting : result->at("settings").as_array()) {
    const auto parameter = setting.at("parameter").to_number<std::uint8_t>();
    // Its chip rounds an acceleration.
    const auto value = setting.at("value").to_number<double>();
    EXPECT_NEAR(get(0, parameter), value, std::abs(value) / 1000) << int{parameter};
  }
  const auto velocity = get(0, ap::max_velocity);
  wire.bench().modules().front()->power_cycle();
  EXPECT_EQ(get(0, ap::max_velocity), velocity);
}

TEST_F(TunedAxis, GoesToTheSwitchThatIsToTell) {
  EXPECT_THAT(end(begin_tuning({{"by_switch", "left"}})).error().message,
              HasSubstr("left limit switch has not stopped the axis"));
  EXPECT_EQ(name_of_error(end(begin_tuning({{"by_switch", "home"}}))), "bad_argument");
  expect_as_before();
}

TEST_F(TunedAxis, IsMovedAndSetByNoOtherClient) {
  const auto answer = tuning_under_way();
  be_another_client();
  EXPECT_EQ(name_of_error(call("axis.move_to", {{"axis", "x"}, {"position", 1}})), "axis_claimed");
  EXPECT_EQ(name_of_error(call("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 1}})),
            "leased");
  EXPECT_TRUE(end(answer));
}

TEST_F(TunedAxis, StandsAndHasItsSettingsAfterAStop) {
  const auto answer = tuning_under_way();
  be_another_client();
  EXPECT_TRUE(call("axis.stop", {{"axis", "x"}}));
  EXPECT_EQ(name_of_error(end(answer)), "superseded_by_stop");
  time.run_for(5s);
  expect_as_before();
}

TEST_F(TunedAxis, StandsAndHasItsSettingsWhenItsClientHasGone) {
  tuning_under_way();
  client_leaves();
  time.run_for(10s);
  be_another_client();
  expect_as_before();
}

TEST_F(TunedAxis, GetsItsSettingsBackWhenTheCableIsThereAgain) {
  const auto answer = tuning_under_way();
  wire.is_cut = true;
  EXPECT_FALSE(end(answer));
  wire.is_cut = false;
  time.run_for(30s);
  expect_as_before();
}

TEST_F(TunedAxis, IsRefusedToOthersThanItsHolder) {
  ASSERT_TRUE(call("lease.acquire", {{"axes", {"x"}}, {"ttl_ms", 60000}}));
  be_another_client();
  EXPECT_EQ(name_of_error(end(begin_tuning())), "leased");
}

TEST_F(TunedAxis, NeedsATravelOrSoftLimitsAndACurrentThatItHas) {
  EXPECT_THAT(end(begin_tuning({{"within", "limits"}})).error().message,
              HasSubstr("no soft limits"));
  EXPECT_EQ(name_of_error(end(begin_tuning({{"from", "1mm"}, {"to", "2mm"}}))), "out_of_range");
  const json::object too_much{
      {"axis", "x"}, {"max_current", 256}, {"from", "-20mm"}, {"to", "20mm"}};
  EXPECT_THAT(call("axis.tune", too_much).error().message, HasSubstr("not within 1 to 255"));
  expect_as_before();
}

struct LimitedAxis : TunedAxis {
  LimitedAxis()
      : TunedAxis(
            "soft_limits = [-20, 20]\nmax_velocity = 8\nmax_acceleration = 50\nmax_current = "
            "150\n") {}
};

TEST_F(LimitedAxis, NeedsItsReference) {
  const auto result = end(begin_tuning({{"within", "limits"}}));
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("has not searched its reference"));
  expect_as_before();
}

TEST_F(LimitedAxis, KeepsToWhatTheConfigurationAllows) {
  ASSERT_TRUE(call("parameter.set", {{"axis", "x"}, {"parameter", 1}, {"value", 0}}));
  const auto result = call("axis.tune", {{"axis", "x"}, {"max_current", 150}});
  ASSERT_TRUE(result) << result.error().message;
  constexpr double of_mm = 51'200 / 5.0;
  EXPECT_EQ(result->at("velocity").at("limited_by"), "bounds");
  for (const auto& trial : result->at("trials").as_array()) {
    EXPECT_LE(trial.at("velocity_pps").to_number<double>(), 8 * of_mm + 1);
    EXPECT_LE(trial.at("current").to_number<int>(), 150);
  }
  ASSERT_TRUE(call("parameter.set", {{"axis", "x"}, {"parameter", 1}, {"value", 0}}));
  EXPECT_EQ(name_of_error(end(begin_tuning({{"within", "limits"}}))), "not_permitted")
      << "a current of 200";
  expect_as_before();
}

}  // namespace
}  // namespace tmcld::test
