// What a chosen ramp, `convert` and `profile simulate` say of the time and length of a ramp is the
// same, and what the generator of the chip does.
#include <gmock/gmock.h>

#include <fmt/format.h>

#include "support/seed.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

namespace plan = tmcl::plan;
using Words = std::vector<std::string>;
/// Values by the names of parameters.
using Settings = std::map<std::string, std::int32_t>;

struct Chip {
  const char* model;
  const char* generator;
  /// Registers of `profile simulate` by the parameters that are chosen.
  std::map<std::string, std::string> registers;
  Words also;  ///< What else the generator needs.
  double greatest_velocity_pps;
};
constexpr double no_bow = std::numeric_limits<double>::infinity();

const Chip tmc429{"TMCM-1110",
                  "tmc429",
                  {{"max_velocity", "v_max"},
                   {"max_acceleration", "a_max"},
                   {"pulse_divisor", "pulse_div"},
                   {"ramp_divisor", "ramp_div"},
                   {"minimum_velocity", "v_min"}},
                  {},
                  200'000};
const Chip tmc457{"TMCM-142",
                  "tmc457",
                  {{"max_velocity", "v_max"},
                   {"acceleration", "a_max"},
                   {"max_deceleration", "d_max"},
                   {"max_bow", "bow_max"}},
                  {},
                  500'000};
const Chip sixpoint{"TMCM-6212",
                    "sixpoint",
                    {{"max_velocity", "vmax"},
                     {"max_acceleration", "amax"},
                     {"max_deceleration", "dmax"},
                     {"acceleration_a1", "a1"},
                     {"deceleration_d1", "d1"},
                     {"velocity_v1", "v1"}},
                    {"vstart=0", "vstop=10"},
                    150'000};

/// A hundredth, and what a generator that counts in steps of time and place makes of it.
void expect_near(tmcl::RampLength expected, const boost::json::object& ramp) {
  EXPECT_NEAR(expected.seconds, ramp.at("duration_s").as_double(), .01 * expected.seconds + 1e-3);
  EXPECT_NEAR(expected.microsteps, ramp.at("microsteps").to_number<double>(),
              .01 * expected.microsteps + 5);
}
class LengthOfARamp : public testing::Test, public CtlBench {
 protected:
  double between(double least, double greatest) {
    return std::exp(std::uniform_real_distribution<>(std::log(least), std::log(greatest))(random_));
  }
  static plan::RampChoice chosen(const Chip& chip, const plan::RampRequest& wish) {
    const auto& model = *tmcl::find_model(chip.model);
    const auto units = chip.generator == tmc429.generator
                           ? tmcl::module_units(tmcl::Tmc429Dividers{2, 3})
                           : *tmcl::module_units(model, std::vector{0});
    return plan::choose_ramp(model, wish, units).value();
  }
  static Settings named(const Chip& chip, const plan::RampChoice& choice) {
    const auto table = tmcl::axis_parameters(*tmcl::find_model(chip.model));
    Settings all;
    for (const auto& setting : choice.settings)
      all[std::string(tmcl::find_parameter(table, setting.parameter)->name)] = setting.value;
    return all;
  }
  boost::json::object simulated(const Chip& chip, const Settings& settings, double microsteps) {
    Words words{"profile", "simulate", "--generator", chip.generator};
    for (const auto& [name, value] : settings) {
      if (const auto found = chip.registers.find(name); found != chip.registers.end())
        words.push_back(fmt::format("{}={}", found->second, value));
    }
    words.insert(words.end(), chip.also.begin(), chip.also.end());
    const char* target_register = chip.generator == sixpoint.generator ? "xtarget" : "x_target";
    words.push_back(fmt::format("{}={:.0f}", target_register, 4 * microsteps + 100));
    return json(words);
  }
  boost::json::object converted(const Chip& chip, const Settings& settings,
                                const char* acceleration) {
    Words words{"convert",        "--model",
                chip.model,       fmt::format("{}", settings.at("max_velocity")),
                "--acceleration", fmt::format("{}", settings.at(acceleration))};
    const auto add = [&](const char* option, const char* parameter) {
      if (const auto found = settings.find(parameter); found != settings.end())
        words.insert(words.end(), {option, std::to_string(found->second)});
    };
    add("--pulse-div", "pulse_divisor");
    add("--ramp-div", "ramp_divisor");
    const auto bow = settings.find("max_bow");
    if (bow != settings.end() && bow->second > 0) add("--bow", "max_bow");
    if (chip.generator != tmc429.generator) words.insert(words.end(), {"--unit-mode", "0"});
    return json(words).at("ramp").as_object();
  }
  void compare(const Chip& chip, double velocity_pps, double seconds, double jerk = no_bow) {
    const double acceleration_pps2 = velocity_pps / seconds;
    SCOPED_TRACE(fmt::format("{} to {} pps at {} pps/s, jerk {}", chip.model, velocity_pps,
                             acceleration_pps2, jerk));
    const auto choice =
        chosen(chip, {{velocity_pps}, {acceleration_pps2}, {acceleration_pps2}, jerk});
    const auto settings = named(chip, choice);
    const auto up = tmcl::ramp_length(choice.velocity, choice.acceleration, {choice.jerk});
    const auto down = tmcl::ramp_length(choice.velocity, choice.deceleration, {choice.jerk});
    const auto moved = simulated(chip, settings, up.microsteps);
    expect_near(up, moved.at("ramp_up").as_object());
    // The law by which a TMC429 brakes is another one: a root in whole numbers.
    if (chip.generator != tmc429.generator) expect_near(down, moved.at("ramp_down").as_object());
    const auto* acceleration =
        settings.contains("acceleration") ? "acceleration" : "max_acceleration";
    const auto told = converted(chip, settings, acceleration);
    EXPECT_NEAR(told.at("duration_s").to_number<double>(), up.seconds, 1e-9 * up.seconds);
    EXPECT_NEAR(told.at("microsteps").to_number<double>(), up.microsteps, 1e-9 * up.microsteps);
  }
  void compare_many(const Chip& chip, double jerk = no_bow) {
    constexpr int times = 40;
    for (int i = 0; i < times && !HasFailure(); ++i) {
      const double v = between(2000, chip.greatest_velocity_pps);
      compare(chip, v, between(.02, 2), jerk);
    }
  }

 private:
  std::mt19937_64 random_{tmcl::test::seed()};
};

TEST_F(LengthOfARamp, IsThatOfATmc429) { compare_many(tmc429); }
TEST_F(LengthOfARamp, IsThatOfATmc457) { compare_many(tmc457); }
TEST_F(LengthOfARamp, IsThatOfSixPoints) { compare_many(sixpoint); }

TEST_F(LengthOfARamp, IsThatOfAnSCurve) { compare_many(tmc457, plan::highest_jerk); }

TEST_F(LengthOfARamp, IsThatOfAnSCurveWithoutFullAcceleration) {
  for (const int bow : {3, 5, 7}) compare(tmc457, 40'000, 0.01, tmcl::to_pps3(bow).value);
}

TEST_F(LengthOfARamp, IsPrinted) {
  EXPECT_EQ(run({"profile", "simulate", "--generator", "tmc429", "v_max=1000", "a_max=500",
                 "pulse_div=2", "ramp_div=3", "x_target=100000"}),
            ExitCode::done);
  EXPECT_THAT(out, testing::ContainsRegex(
                       "^up to speed in 0.[0-9]+ s and [0-9]+ microsteps, and down to rest in "));
  EXPECT_EQ(run({"convert", "--model", "TMCM-142", "40000pps", "--acceleration", "400000pps/s"}),
            ExitCode::done);
  EXPECT_THAT(out, testing::HasSubstr("from rest to this velocity, or back"));
}

TEST_F(LengthOfARamp, OfADirectionIsThatOfTheOther) {
  const Words ahead{"convert", "--model", "TMCM-142", "40000pps", "--acceleration", "400000pps/s"};
  auto back = ahead;
  back[3] = "-40000pps";
  EXPECT_EQ(json(back).at("ramp"), json(ahead).at("ramp"));
}

TEST_F(LengthOfARamp, NeedsAVelocityAndAnAcceleration) {
  for (const char* quantity : {"5rev", "400000pps/s"})
    EXPECT_EQ(run({"convert", "--model", "TMCM-142", quantity, "--acceleration", "4000pps/s"}),
              ExitCode::usage);
  EXPECT_EQ(run({"convert", "--model", "TMCM-142", "5pps", "--acceleration", "0"}),
            ExitCode::usage);
  EXPECT_EQ(run({"convert", "--model", "TMCM-142", "--acceleration", "10"}), ExitCode::usage);
}

}  // namespace
}  // namespace tmclctl::test
