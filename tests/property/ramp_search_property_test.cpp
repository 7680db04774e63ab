// Ramps that are sought, against all ramps of a coarse grid, against the twin of the axis, and on
// simulated motors that have just the torque that was reckoned with.
#include "tmcl/plan/ramp_search.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/lone_module.hpp"
#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {
namespace {

const std::vector<std::string> with_smooth_ramps{"TMCM-142", "TMCM-6212", "TMCM-1378"};
const std::vector<std::string> one_of_each_family{"TMCM-1110", "TMCM-142", "TMCM-6212",
                                                  "TMCM-1378"};
constexpr double full_step = 256;
// What is rounded to whole registers, and what the halving leaves.
constexpr double near = 0.01;

RampSearch search_on(const std::string& name, std::int32_t distance) {
  const auto* model = find_model(name);
  RampSearch search{{"x", model, initial_units(*model)}, {distance}};
  if (model->family == Family::tmc457)
    search.present_bow = find_parameter(axis_parameters(*model), number_of("max_bow"))->initial;
  return search;
}

struct Candidate {
  double acceleration;
  FollowedMove move;
};

/// All that arrive, of 12 velocities and 30 accelerations.
std::vector<Candidate> grid_of(const RampSearch& search) {
  constexpr int velocities = 12;
  constexpr int accelerations = 30;
  std::vector<Candidate> all;
  for (int i = 0; i < velocities; ++i) {
    const double velocity = 800 * std::pow(450'000.0 / 800, (i + 0.5) / velocities);
    for (int k = 0; k < accelerations; ++k) {
      const double acceleration = 500 * std::pow(7e6 / 500, (k + 0.5) / accelerations);
      const RampWish wish{{velocity, "pps"}, {acceleration, "pps/s"}};
      const auto planned = plan_ramp(wish, search.units, search.present_bow);
      if (!planned) continue;
      auto move = follow_move(*search.units.model, planned->choice.settings, search.distance);
      if (!move || !move->seconds) continue;
      all.push_back({planned->choice.acceleration.value, std::move(*move)});
    }
  }
  return all;
}

class RampSearchOf : public testing::TestWithParam<std::string> {
 protected:
  tmcl::test::Random<> random{tmcl::test::seed()};

  std::int32_t any_distance() {
    return static_cast<std::int32_t>(random.either_way(100 + random.any_size(1'000'000)));
  }
};

TEST_P(RampSearchOf, NoRampOfAGridIsGentlerAndInTime) {
  for (int round = 0; round < tmcl::test::rounds(4); ++round) {
    const auto search = search_on(GetParam(), any_distance());
    const double way = std::abs(static_cast<double>(search.distance.value));
    const double seconds = way / static_cast<double>(random.between(500, 200'000)) + 0.01;
    SCOPED_TRACE(testing::Message() << search.distance.value << " in " << seconds << " s");
    const auto found = gentlest_ramp(search, seconds);
    for (const auto& [acceleration, move] : grid_of(search)) {
      if (*move.seconds > seconds) continue;
      ASSERT_TRUE(found) << describe(found.error(), search) << ", but with " << acceleration;
      EXPECT_GE(acceleration, (1 - near) * found->planned.choice.acceleration.value);
    }
    if (!found) continue;
    EXPECT_LE(*found->move.seconds, seconds);
    const auto again =
        follow_move(*search.units.model, found->planned.choice.settings, search.distance);
    EXPECT_EQ(again->seconds, found->move.seconds) << "with the settings that it says";
  }
}

MotorWish any_motor(tmcl::test::Random<>& random) {
  MotorWish motor;
  motor.torque.load = static_cast<double>(random.between(0, 300));
  motor.torque.load_per_velocity = static_cast<double>(random.between(0, 200));
  motor.torque.inertia = static_cast<double>(random.between(1'000, 500'000));
  if (!random.one_in(4)) motor.torque.corner_speed = static_cast<double>(random.between(50, 2000));
  motor.margin = static_cast<double>(random.between(5, 100)) / 100;
  motor.microsteps_per_full_step = full_step;
  return motor;
}

std::string described(const MotorWish& motor) {
  const auto& torque = motor.torque;
  return fmt::format("load {}, friction {}, inertia {}, corner {}, margin {}", torque.load,
                     torque.load_per_velocity, torque.inertia, torque.corner_speed.value_or(0),
                     motor.margin);
}

TEST_P(RampSearchOf, NoRampOfAGridIsQuickerWithinTheTorque) {
  for (int round = 0; round < tmcl::test::rounds(3); ++round) {
    const auto search = search_on(GetParam(), any_distance());
    const auto motor = any_motor(random);
    const double most = 1 / (1 + motor.margin);
    SCOPED_TRACE(testing::Message() << search.distance.value << ", " << described(motor));
    const auto found = quickest_ramp(search, motor);
    ASSERT_TRUE(found) << describe(found.error(), search);
    EXPECT_LE(torque_use(found->move, motor.torque, full_step).share, most);
    // Whatever velocities are tried, the dividers of a TMC429 may suit another one better; and the
    // torque is looked at every millisecond.
    const double little = GetParam() == "TMCM-1110" ? 4 * near : near;
    constexpr double few_looks = 3e-3;
    for (const auto& [acceleration, move] : grid_of(search)) {
      if (torque_use(move, motor.torque, full_step).share > most) continue;
      EXPECT_GE(*move.seconds, (1 - little) * *found->move.seconds - few_looks) << acceleration;
    }
  }
}

/// Whether a simulated motor with so many times the load loses steps with this ramp.
bool loses_steps(const RampSearch& search, const FoundRamp& found, const MotorTorque& torque,
                 double times) {
  const auto figure = [&](double value) { return static_cast<std::int32_t>(times * value); };
  // Where a stage stands is of no interest without something on it, such as an encoder.
  sim::StageSettings stage{.encoder = sim::EncoderSettings{51'200},
                           .load = figure(torque.load),
                           .load_per_velocity = figure(torque.load_per_velocity),
                           .inertia = figure(torque.inertia)};
  if (torque.corner_speed) stage.corner_speed = static_cast<std::int32_t>(*torque.corner_speed);
  test::LoneModule world(search.units.model->number, stage);
  for (const auto& [parameter, value] : found.planned.choice.settings)
    EXPECT_EQ(world.ask(Command::SAP, parameter, value).status, Status::ok);
  world.ask(Command::MVP, 0, search.distance.value);
  world.look_at(world.clock.now() + std::chrono::duration_cast<Duration>(
                                        std::chrono::duration<double>(*found.move.seconds + 0.01)));
  EXPECT_EQ(world.ask(Command::GAP, axis_parameter::actual_position, 0).value,
            search.distance.value);
  return world.module.stage(0).position() != search.distance.value;
}

// It looks at speed and load every millisecond, as the search does; but at each stair of a TMC429,
// whose ramps the search takes as smooth.
using SmoothRampOf = RampSearchOf;
TEST_P(SmoothRampOf, IsJustWhatASimulatedMotorHasTheTorqueFor) {
  for (int round = 0; round < tmcl::test::rounds(4); ++round) {
    const auto search =
        search_on(GetParam(), static_cast<std::int32_t>(random.between(5'000, 500'000)));
    const auto motor = any_motor(random);
    SCOPED_TRACE(testing::Message() << search.distance.value << ", " << described(motor));
    const auto found = quickest_ramp(search, motor);
    ASSERT_TRUE(found);
    EXPECT_FALSE(loses_steps(search, *found, motor.torque, 1));
    const auto use = torque_use(found->move, motor.torque, full_step);
    constexpr double more = 1.25;
    if (use.share * more * (1 + motor.margin) > 1.1) {
      EXPECT_TRUE(loses_steps(search, *found, motor.torque, more * (1 + motor.margin)));
    }
  }
}

constexpr auto name_of_model = [](const auto& model) {
  auto name = model.param;
  std::erase(name, '-');
  return name;
};
INSTANTIATE_TEST_SUITE_P(EachFamily, RampSearchOf, testing::ValuesIn(one_of_each_family),
                         name_of_model);
INSTANTIATE_TEST_SUITE_P(EachFamily, SmoothRampOf, testing::ValuesIn(with_smooth_ramps),
                         name_of_model);

}  // namespace
}  // namespace tmcl::plan
