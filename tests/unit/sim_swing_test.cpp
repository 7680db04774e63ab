// A load that swings behind its motor, as an encoder on it tells.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/lone_module.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr ramp::Resonance of_the_load{8, 0.05};

/// On each kind of ramp generator: a model, the parameter of its encoder, and its ramp.
struct Generator {
  const char* model;
  std::uint8_t encoder;
  std::vector<std::pair<std::uint8_t, std::int32_t>> ramp;
};
void PrintTo(const Generator& generator, std::ostream* out) { *out << generator.model; }

struct SwingOf : testing::TestWithParam<Generator> {
  SwingOf() {
    for (const auto& [parameter, value] : GetParam().ramp)
      EXPECT_EQ(module.ask(Command::SAP, parameter, value).status, Status::ok) << int{parameter};
  }
  static StageSettings stage() {
    StageSettings settings;
    settings.encoder = EncoderSettings{51'200, false};
    settings.resonance = of_the_load;
    return settings;
  }
  std::int32_t get(std::uint8_t parameter) const {
    return module.module.axis(0).get(parameter).value_or(0);
  }
  double motor() const { return get(ap::actual_position); }
  double load() const { return get(GetParam().encoder); }
  void pass(Duration time) { module.look_at(module.clock.now() + time); }

  test::LoneModule module{find_model(GetParam().model)->number, stage()};
};

// y'' = -2 d w (y' - x') - w^2 (y - x) in steps so small that the method does not matter.
TEST_P(SwingOf, ObeysItsEquation) {
  constexpr auto step = microseconds(100);
  const double h = std::chrono::duration<double>(step).count();
  const double w = 2 * std::numbers::pi * of_the_load.frequency_hz;
  double position = 0;
  double speed = 0;
  double before = 0;
  double farthest = 0;
  const auto follow = [&](Duration time) {
    for (Duration passed{}; passed < time; passed += step) {
      pass(step);
      const double x = motor();
      const double v = (x - before) / h;
      const double halfway = position + h / 2 * speed - (x + before) / 2;
      before = x;
      position += h / 2 * speed;
      speed += h * (-2 * of_the_load.damping * w * (speed - v) - w * w * halfway);
      position += h / 2 * speed;
      farthest = std::max(farthest, std::abs(position - x));
      // What the encoder counts is whole, and the motor makes whole steps.
      ASSERT_NEAR(load(), position, 4 + 0.01 * farthest);
    }
  };
  module.ask(Command::MVP, 0, 20'000);
  follow(milliseconds(300));
  module.ask(Command::MVP, 0, -5'000);
  follow(milliseconds(1'000));
  EXPECT_GT(farthest, 100) << "it swings";
}

TEST_P(SwingOf, ComesToRestWhereTheMotorStands) {
  module.ask(Command::MVP, 0, 10'000);
  pass(std::chrono::seconds(20));
  EXPECT_EQ(motor(), 10'000);
  EXPECT_NEAR(load(), 10'000, 1);
}

TEST_P(SwingOf, LookingChangesNothing) {
  test::LoneModule seldom{find_model(GetParam().model)->number, stage()};
  for (const auto& [parameter, value] : GetParam().ramp) seldom.ask(Command::SAP, parameter, value);
  for (const auto target : {12'345, -700, 700}) {
    for (auto* one : {&seldom, &module}) one->ask(Command::MVP, 0, target);
    for (int i = 0; i < 700; ++i) pass(microseconds(333 + i));
    seldom.look_at(module.clock.now());
    EXPECT_EQ(seldom.module.axis(0).get(GetParam().encoder).value(), load());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, SwingOf,
    testing::Values(Generator{"TMCM-1110", 209, {{153, 7}, {154, 3}, {4, 1000}, {5, 500}}},
                    Generator{"TMCM-142", 41, {{4, 6'700'000}, {16, 7'000}, {17, 7'000}, {18, 6}}},
                    Generator{
                        "TMCM-1276", 209, {{4, 100'000}, {5, 400'000}, {16, 0}, {17, 400'000}}},
                    Generator{"TMCM-3351", 209, {{4, 100'000}, {5, 400'000}, {17, 400'000}}}),
    [](const auto& info) {
      std::string name = info.param.model;
      std::erase(name, '-');
      return name;
    });

TEST(Swing, IsHowTheLoadHangsBackWhileTheMotorAccelerates) {
  Swing swing({10, 0.1});
  swing.keep(0);
  swing.look(TimePoint{std::chrono::seconds(20)}, 20'000);
  EXPECT_NEAR(swing.offset(), -1000 / std::pow(20 * std::numbers::pi, 2), 1e-6);
  swing.keep(20'000);
  swing.look(TimePoint{std::chrono::seconds(40)}, 20'000);
  EXPECT_NEAR(swing.offset(), 0, 1e-6);
}

TEST(Swing, IsBegunByASpeedThatIsTakenAtOnce) {
  Swing swing({10, 0});
  swing.keep(3000);
  swing.look(TimePoint{std::chrono::milliseconds(25)}, 3000);
  EXPECT_NEAR(swing.offset(), -3000 / (20 * std::numbers::pi), 1e-6) << "a quarter of a swing";
}

}  // namespace
}  // namespace tmcl::sim
