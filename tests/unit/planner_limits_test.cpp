// Lines and paths keep what their axes' own settings say, in both directions, and give everything
// back as it was.
#include <gmock/gmock.h>

#include <algorithm>

#include "support/no_events.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_limits.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::AnyOf;
using tmcl::Command;
using tmcl::number_of;
using tmcl::plan::Setting;

constexpr auto dmax = number_of("max_deceleration");
constexpr auto bow = number_of("max_bow");
constexpr auto a1 = number_of("acceleration_a1");
constexpr auto d1 = number_of("deceleration_d1");
constexpr auto v1 = number_of("velocity_v1");

using Settings = std::vector<Setting>;

tmcl::plan::RampLimits limits(std::string_view model, const Settings& settings) {
  return tmcl::plan::ramp_limits(*tmcl::find_model(model), settings);
}

TEST(RampLimits, AreTheSmallerOneOfAccelerationAndDeceleration) {
  EXPECT_EQ(limits("TMCM-1110", {{4, 900}, {5, 300}}), (tmcl::plan::RampLimits{900, 300}));
  // Parameter 5 of a TMC457 says nothing of its own.
  const Settings tmc457{{4, 900}, {5, 100}, {16, 300}, {dmax, 200}};
  EXPECT_EQ(limits("TMCM-142", tmc457), (tmcl::plan::RampLimits{900, 200}));
  EXPECT_EQ(limits("TMCM-6212", {{4, 900}, {5, 300}, {dmax, 400}}).acceleration, 300);
  EXPECT_EQ(limits("TMCM-6212", {{4, 900}, {5, 300}, {dmax, 200}}).acceleration, 200);
  EXPECT_EQ(limits("TMCM-6212", {{4, 900}, {5, 300}, {dmax, 0}}).acceleration, 300);
  EXPECT_EQ(limits("TMCM-6212", {{4, 900}, {5, 0}, {dmax, 400}}).acceleration, 0);
  // There this number is a window of velocities.
  EXPECT_EQ(limits("TMCM-1311", {{4, 900}, {5, 300}, {dmax, 1}}).acceleration, 300);
}

TEST(RampLimits, AreReadFromParametersThatTheModelHas) {
  for (const auto& model : tmcl::models()) {
    const auto parameters = tmcl::plan::ramp_limit_parameters(model);
    EXPECT_GE(parameters.size(), 2U) << model.name;
    for (const auto parameter : parameters) {
      const auto* row = find_parameter(axis_parameters(model), parameter);
      ASSERT_NE(row, nullptr) << model.name;
      EXPECT_THAT(row->name,
                  AnyOf("max_velocity", "max_acceleration", "acceleration", "max_deceleration"))
          << model.name;
    }
  }
}

class PlannerLimits {
 public:
  PlannerLimits(std::string_view model, const Settings& settings)
      : bench_(model, "unit = \"mm\"\nunits_per_revolution = 5\n"),
        model_(tmcl::find_model(model)) {
    for (const auto* axis : {"x", "y"}) {
      if (model_->axes == 1 && *axis == 'y') continue;
      for (const auto [parameter, value] : settings) set(axis, parameter, value);
    }
    before_ = all_settings();
  }

  double duration_of_path() {
    const auto planned = bench_.call("path.plan", path());
    EXPECT_TRUE(planned) << planned.error().message;
    return planned->at("course").at("duration_s").to_number<double>();
  }
  void run_path(const char* mode) {
    auto params = path();
    params["mode"] = mode;
    const auto ended = bench_.call("path.run", params);
    EXPECT_TRUE(ended) << ended.error().message;
  }
  void expect_settings_as_before() { EXPECT_EQ(all_settings(), before_); }
  std::vector<std::int32_t> written(std::uint8_t parameter) const {
    std::vector<std::int32_t> values;
    for (const auto& request : bench_.requests)
      if (request.command == Command::SAP && request.type == parameter)
        values.push_back(request.value);
    return values;
  }

 private:
  /// Not all modules have a second motor.
  const char* other() const { return model_->axes > 1 ? "y" : "far"; }
  json::object path() const {
    return {{"axes", json::array{"x", other()}}, {"text", "G1 X2 Y1 F6000\nG1 X1 Y3\n"}};
  }
  void set(std::string_view axis, int parameter, std::int32_t value) {
    const auto result =
        bench_.call("parameter.set", {{"axis", axis}, {"parameter", parameter}, {"value", value}});
    EXPECT_TRUE(result) << parameter << ": " << result.error().message;
  }
  std::int32_t read(std::uint8_t parameter) {
    const tmcl::Request request{tmcl::ModuleAddress{1}, Command::GAP, parameter, 0, 0};
    auto& module = *bench_.wire.bench().modules().front();
    return module.execute(request, tmcl::sim::Medium::serial, nothing_).value;
  }
  Settings all_settings() {
    Settings all;
    for (const auto parameter : tmcl::plan::AxisTwin::parameters(*model_))
      all.push_back({parameter, read(parameter)});
    return all;
  }
  tmcl::test::NoEvents nothing_;
  JourneyBench bench_;
  const tmcl::Model* model_;
  Settings before_;
};

struct Family {
  std::string name;
  std::string model;
  Settings settings;  ///< The first is max_velocity.
};
void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }

class LimitsOf : public testing::TestWithParam<Family> {};

TEST_P(LimitsOf, APathTakesAsLongAsTheLeastOfThemSays) {
  auto settings = GetParam().settings;
  const auto quick = PlannerLimits(GetParam().model, settings).duration_of_path();
  for (auto& setting : settings) {
    const auto own = setting.value;
    const auto counts = tmcl::plan::ramp_limit_parameters(*tmcl::find_model(GetParam().model));
    if (setting.parameter == 4 || std::ranges::count(counts, setting.parameter) == 0) continue;
    setting.value = own / 10;
    EXPECT_GT(PlannerLimits(GetParam().model, settings).duration_of_path(), quick * 1.2)
        << int{setting.parameter};
    setting.value = own;
  }
}

// What makes up for a difference is no reason to be faster.
TEST_P(LimitsOf, APathIsNotFasterThanItsAxes) {
  for (const auto* mode : {"velocity", "segments", "position"}) {
    if (std::string_view(mode) == "position" && GetParam().model != "TMCM-6212") continue;
    PlannerLimits planner(GetParam().model, GetParam().settings);
    planner.run_path(mode);
    const auto& top = GetParam().settings.front();
    const auto told = planner.written(top.parameter);
    ASSERT_FALSE(told.empty());
    EXPECT_EQ(std::ranges::max(told), top.value) << mode;
  }
}

TEST_P(LimitsOf, APathGivesAllOfThemBack) {
  auto settings = GetParam().settings;
  for (auto& setting : settings)
    if (setting.parameter != 4) setting.value -= 13 * setting.parameter;
  PlannerLimits planner(GetParam().model, settings);
  planner.run_path("velocity");
  planner.expect_settings_as_before();
  planner.run_path("segments");
  planner.expect_settings_as_before();
  if (GetParam().model != "TMCM-6212") return;
  planner.run_path("position");
  planner.expect_settings_as_before();
}

TEST(PathOnTmc457, HasNoBowWhileVelocitiesAreStreamed) {
  PlannerLimits planner("TMCM-142", {{4, 5'000'000}, {16, 20'000}, {dmax, 15'000}, {bow, 3}});
  planner.run_path("velocity");
  EXPECT_THAT(planner.written(bow), testing::ElementsAre(3, 0, 3));
  EXPECT_TRUE(planner.written(5).empty()) << "it sets both accelerations";
  planner.expect_settings_as_before();
}

INSTANTIATE_TEST_SUITE_P(
    Families, LimitsOf,
    testing::Values(Family{"Tmc429", "TMCM-3110", {{4, 1000}, {5, 200}}},
                    Family{"Tmc457", "TMCM-142", {{4, 5'000'000}, {16, 20'000}, {dmax, 20'000}}},
                    Family{"SixPoint",
                           "TMCM-6212",
                           {{4, 100'000},
                            {5, 400'000},
                            {a1, 400'000},
                            {v1, 50'000},
                            {dmax, 400'000},
                            {d1, 400'000}}}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace tmcld::test
