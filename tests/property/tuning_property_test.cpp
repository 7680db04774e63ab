// Axes with loads of all kinds are tuned: what is found is near what the model of the load bears,
// and never above it; and the axis is left as it was.
#include "tmcl/tuning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/stage/motor_load.hpp"
#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/verified_module.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/motor_torque.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/plan/ramp_wish.hpp"

namespace tmcl {
namespace {

using std::chrono::milliseconds;
namespace ap = axis_parameter;

constexpr double full_step = 256;
constexpr std::int32_t greatest_current = 255;
constexpr std::string_view usual_model = "TMCM-1276";
constexpr std::string_view bowed_model = "TMCM-142";
constexpr double scales = 32;
/// What is found may be so far below what the load bears: 2 % of the search and 8 % of the model,
/// which looks at torque every millisecond.
constexpr double near = 0.1;
/// What stands off by less is not seen: half a full step at rest, and 0.3 by the encoder's ratio.
constexpr double full_steps_unseen = 0.8;

/// In full steps.
struct Truth {
  plan::MotorTorque torque;
  double acceleration = 0;  ///< That the axis has at first.

  bool bears(double speed, double at) const {
    return torque.asked(speed, at) < torque.there(speed);
  }
  double greatest_speed(double at) const {
    double low = 0;
    double high = 1e6;
    while (high - low > 0.01) {
      const auto middle = (low + high) / 2;
      (bears(middle, at) ? low : high) = middle;
    }
    return low;
  }
  double greatest_speed() const { return greatest_speed(acceleration); }
  /// How far a ramp goes while it asks for more torque than there is.
  double short_of_torque(double speed, double at) const {
    const auto borne = std::min(greatest_speed(at), speed);
    return (speed * speed - borne * borne) / (2 * at);
  }
  /// The same of a ramp whose acceleration rises and falls by so much a second.
  double short_of_torque(double speed, double at, double jerk) const {
    constexpr int pieces = 10'000;
    double way = 0;
    for (int i = 0; i < pieces; ++i) {
      const double now = speed * (i + 0.5) / pieces;
      const auto rising = std::sqrt(2 * jerk * std::min(now, speed - now));
      const auto acceleration = std::min(at, rising);
      if (!bears(now, acceleration)) way += now * speed / pieces / acceleration;
    }
    return way;
  }
  /// A ramp to a greater speed is short of torque for so long that the tuner sees it.
  double greatest_speed_unseen() const {
    const auto speed = greatest_speed();
    return std::max(1.05 * speed, std::sqrt(speed * speed + 2 * acceleration * full_steps_unseen));
  }
  double greatest_acceleration(double speed) const {
    return (torque.there(speed) - torque.asked(speed, 0)) * 1e6 / torque.inertia;
  }
};

struct Load {
  sim::StageSettings stage;
  Truth truth;
  ValueRange travel{};
  std::int32_t standby_current = 0;  ///< Enough.

  /// The least of parameter 7 with which its scale leaves enough torque at rest. The torque of a
  /// stage is in whole thousandths: of 62.5 there are 62, which do not hold 62.
  std::int32_t least_standby_current() const {
    const auto asked = sim::torque_demanded_at_rest(stage);
    std::int32_t scale = 0;
    while (1000 * (scale + 1) / 32 <= asked) ++scale;
    return 8 * scale;
  }
  std::string text() const {
    return "load " + std::to_string(stage.load) + ", friction " +
           std::to_string(stage.load_per_velocity) + ", pull " + std::to_string(stage.pull) +
           ", standby " + std::to_string(standby_current) + ", inertia " +
           std::to_string(stage.inertia) + ", corner " + std::to_string(*stage.corner_speed) +
           ", encoder " + std::to_string(stage.encoder ? stage.encoder->counts_per_turn : 0) +
           ", backlash " + std::to_string(stage.backlash) + ", noise " +
           std::to_string(stage.load_value_noise) + ", pull in " +
           std::to_string(stage.pull_in_speed.value_or(-1)) + ", acceleration " +
           std::to_string(truth.acceleration);
  }
};

class Loads : public test::Random<std::int32_t> {
 public:
  using Random::Random;

  Load any() {
    Load load;
    auto& stage = load.stage;
    stage.load = between(0, 300);
    stage.load_per_velocity = between(0, 300);
    if (one_in(2)) stage.pull = between(-250, 250);
    stage.inertia = between(10'000, 300'000);
    stage.corner_speed = between(150, 1500);
    if (one_in(2)) stage.pull_in_speed = between(0, 200);
    stage.torque_follows_current = true;
    stage.load_value_slope = between(400, 1200);
    stage.load_value_noise = between(0, 30);
    stage.backlash = one_in(2) ? 0 : between(1, 1000);
    stage.encoder = sim::EncoderSettings{between(1'000, 60'000), one_in(4)};
    stage.full_steps_per_turn = one_in(2) ? 200 : 400;
    // Against what pulls.
    load.truth.torque.load = stage.load + std::abs(stage.pull);
    load.truth.torque.load_per_velocity = stage.load_per_velocity;
    load.truth.torque.inertia = stage.inertia;
    load.truth.torque.corner_speed = *stage.corner_speed;
    load.truth.acceleration = between(50, 250) / 1000.0 * 1e9 / stage.inertia;
    const double speed = load.truth.greatest_speed();
    const double way = 1.2 * speed * speed / load.truth.acceleration + speed + 200;
    const auto half = static_cast<std::int32_t>(way * full_step / 2);
    load.travel = {-half - between(0, 5000), half};
    load.standby_current = between(load.least_standby_current(), 128);
    return load;
  }
};

class Tuned {
 public:
  Tuned(const Load& load, std::uint64_t seed, std::string_view model = usual_model)
      : load_(load), model_(*find_model(model)), module_(model_, {}, load.stage) {
    module_.random.seed(seed);
    module_.exchange_time = {milliseconds(2), milliseconds(4)};
    if (find_parameter(axis_parameters(model_), ap::unit_mode) != nullptr) set(ap::unit_mode, 1);
    set(ap::max_velocity, 51'200);
    set(ap::max_acceleration, static_cast<std::int32_t>(load.truth.acceleration * full_step));
    // Not less: with what is drawn the axis stands.
    const auto of_range = [this](std::uint8_t parameter, std::int32_t of_256) {
      set(parameter, (of_256 * (greatest(parameter) + 1) + 255) / 256);
    };
    if (model_.family == Family::sixpoint) set(number_of("stallguard2_threshold"), 3);
    of_range(number_of("standby_current"), load.standby_current);
    module_.after_each = [this] {
      const auto place = module_.lone.module.stage(0).position();
      least_place_ = std::min(least_place_, place);
      most_place_ = std::max(most_place_, place);
    };
  }

  Result<Tuning> tune() {
    TuneOptions options;
    std::vector<std::int32_t> counted;
    for (const auto parameter : unit_parameters(model_)) counted.push_back(module_.get(parameter));
    options.units = {"x", &model_, *module_units(model_, counted)};
    for (const auto parameter : tune_parameters(model_))
      options.settings.push_back({parameter, module_.get(parameter)});
    options.max_current = greatest(number_of("max_current"));
    options.travel = load_.travel;
    options.by_switch = by_switch;
    before_ = options.settings;
    return module_.run(verbs::tune({ModuleAddress{1}, 0}, options));
  }
  std::optional<LimitSwitch> by_switch;

  void expect_left_as_it_was() {
    for (const auto& [parameter, value] : before_)
      EXPECT_EQ(module_.get(parameter), value) << int{parameter};
    EXPECT_EQ(module_.get(ap::actual_velocity), 0);
    EXPECT_EQ(module_.get(ap::actual_position), 0);
    EXPECT_NEAR(static_cast<double>(module_.lone.module.stage(0).position()), 0, full_step);
    EXPECT_GE(least_place_, load_.travel.least);
    EXPECT_LE(most_place_, load_.travel.greatest);
  }

 private:
  void set(std::uint8_t parameter, std::int32_t value) {
    EXPECT_EQ(module_.lone.ask(Command::SAP, parameter, value).status, Status::ok)
        << int{parameter};
  }

  std::int32_t greatest(std::uint8_t parameter) const {
    return find_parameter(axis_parameters(model_), parameter)->maximum;
  }

  const Load& load_;
  const Model& model_;
  test::VerifiedModule module_;
  std::vector<plan::Setting> before_;
  sim::Place least_place_ = 0;
  sim::Place most_place_ = 0;
};

/// The least of parameter 6 with which its scale leaves enough torque.
double least_current(const Truth& truth, double speed, double acceleration) {
  const auto scale = std::floor(scales * truth.torque.asked(speed, acceleration) / 1000);
  return 8 * scale;
}

/// With which the load value keeps off 0 by a tenth of its range, when it is read so much too low.
double least_threshold(const Load& load, double speed, double current, double too_low) {
  const auto there =
      std::min(1000 * (std::floor(current / 8) + 1) / scales, load.truth.torque.there(speed));
  const auto share = load.truth.torque.asked(speed, 0) / there;
  return (0.1 * 1024 + load.stage.load_value_slope * share + too_low - 500) / 8;
}

void expect_hold_current(const Load& load, const Tuning& found) {
  ASSERT_TRUE(found.hold_current);
  const auto least = load.least_standby_current();
  const auto& hold = *found.hold_current;
  EXPECT_GE(hold.limit, least);
  EXPECT_LT(hold.limit, least + 8);
  EXPECT_GE(hold.proposed, least);
  // It stood with none.
  if (least != 0) {
    EXPECT_EQ(hold.limited_by, LimitedBy::motor);
  }
  if (hold.limited_by == LimitedBy::motor) {
    EXPECT_GE(hold.proposed, least + 8);
  }
  const auto slid = [](const TuneTrial& one) { return one.sought == Sought::hold && !one.held; };
  EXPECT_LE(std::ranges::count_if(found.trials, slid), 1);
}

struct Tally {
  int all = 0;
  int by_motor = 0;  ///< The motor, not the travel, limits their velocity.
  int far_velocities = 0;
  int far_accelerations = 0;
  int other_bows = 0;
};

/// Where the travel or the chip is the limit, the motor may bear more: the tuner does not try that.
bool is_far(const TunedValue& found, double truth) {
  const auto limit = found.limit / full_step;
  const bool is_of_motor = found.limited_by == LimitedBy::motor;
  return (limit < (1 - near) * truth && is_of_motor) || limit > (1 + near) * truth;
}

void tune_load_of(std::uint64_t seed, Tally& tally) {
  Loads random(seed);
  const auto load = random.any();
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ": " + load.text());
  Tuned tuned(load, seed);
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  ++tally.all;
  const auto speed = load.truth.greatest_speed();
  const auto velocity = found->velocity.limit / full_step;
  EXPECT_LT(velocity, load.truth.greatest_speed_unseen());
  tally.far_velocities += std::abs(velocity / speed - 1) > near ? 1 : 0;
  const auto proposed = found->velocity.proposed / full_step;
  const auto greatest = load.truth.greatest_acceleration(proposed);
  tally.far_accelerations += is_far(found->acceleration, greatest) ? 1 : 0;
  const auto at = found->acceleration.proposed / full_step;
  EXPECT_LT(load.truth.short_of_torque(proposed, at), full_steps_unseen) << proposed << ' ' << at;
  // The ramp of the search for current and threshold; the confirmation may have made it slower.
  const auto sought = std::ranges::find(found->trials, Sought::current, &TuneTrial::sought);
  ASSERT_NE(sought, found->trials.end());
  const auto sought_speed = sought->velocity.value / full_step;
  const auto sought_at = sought->acceleration.value / full_step;
  EXPECT_LE(proposed, 1.001 * sought_speed);
  EXPECT_LE(at, 1.001 * sought_at);
  const auto least =
      std::max(least_current(load.truth, sought_speed, sought_at), greatest_current / 4.0);
  EXPECT_GE(found->current.proposed, least - 8);
  EXPECT_LE(found->current.limit, 1.1 * least + 16);
  if (found->threshold) {
    const auto current = found->current.proposed;
    const double noise = load.stage.load_value_noise;
    EXPECT_GE(*found->threshold, least_threshold(load, sought_speed, current, -noise) - 1);
    EXPECT_LE(*found->threshold, least_threshold(load, sought_speed, current, noise) + 4);
  }
  expect_hold_current(load, *found);
  EXPECT_NEAR(found->backlash, static_cast<double>(load.stage.backlash), full_step / 2);
  tuned.expect_left_as_it_was();
}

/// Tunes `usual` loads (or TMCL_ROUNDS), and up to ten times as many until `enough` holds: a few
/// loads may be unlike most.
template <class Enough>
void tune_loads(void (*tune)(std::uint64_t, Tally&), int usual, Enough enough) {
  constexpr int most = 10;
  Tally tally;
  const auto rounds = test::rounds(usual);
  auto seed = test::seed();
  while (tally.all < rounds || (!enough(tally) && tally.all < most * rounds)) {
    tune(seed++, tally);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_TRUE(enough(tally)) << "of " << tally.all << " loads: velocities that are far off "
                             << tally.far_velocities << ", accelerations "
                             << tally.far_accelerations << ", other bows " << tally.other_bows
                             << ", limited by the motor " << tally.by_motor;
}

/// One in 20 may be far off.
bool is_near(const Tally& tally) {
  const auto far = tally.all / 20 + 1;
  return tally.far_velocities <= far && tally.far_accelerations <= far;
}

TEST(TuningProperty, FindsNearlyWhatTheLoadBearsAndNoMore) {
  tune_loads(tune_load_of, 10, is_near);
}

// ---- A load that swings, on a module with bows -------------------------------------------------

/// When a load stands after a move to speed and back, in seconds; the longest of some moves.
double settled_s(const Tuning& found, std::int32_t bow, double way,
                 const ramp::Resonance& resonance) {
  const auto& model = *find_model(bowed_model);
  const AxisUnits units{"", &model, initial_units(model)};
  plan::RampWish wish{{found.velocity.proposed, "pps"}, {found.acceleration.proposed, "pps/s"}};
  wish.jerk = plan::JerkWish{.quantity = {}, .bow = bow, .highest = false};
  const auto ramp = plan::plan_ramp(wish, units, 0);
  EXPECT_TRUE(ramp);
  double longest = 0;
  for (const double part : {0.0, 0.3, 0.7}) {
    const auto velocity = ramp->choice.velocity.value;
    const double distance = way + part * velocity / resonance.frequency_hz;
    const auto verdict = plan::judge_variant(model, ramp->choice.settings, {},
                                             Microsteps{static_cast<std::int32_t>(distance)},
                                             plan::LoadWish{resonance, full_step / 10});
    longest = std::max(longest, verdict->settled_s.value_or(1e9) - (distance - way) / velocity);
  }
  return longest;
}

/// With less the generator itself swings about its target with the bow that the axis has: that is
/// no ramp with which it moves for certain.
double least_acceleration_with_bow(std::int32_t bow) {
  const InternalAcceleration least{1 << (bow - 1)};
  return to_pps2(least, initial_units(*find_model(bowed_model))).value / full_step;
}

/// What it swings by is within what trials take for lost steps.
Load swinging_load(std::uint64_t seed) {
  Loads random(seed);
  auto load = random.any();
  load.truth.acceleration =
      std::max(load.truth.acceleration, 1.05 * least_acceleration_with_bow(11));
  const auto steepest = load.truth.greatest_acceleration(0);
  const auto least_hz = std::sqrt(2 * steepest / 1.5) / (2 * std::numbers::pi);
  load.stage.resonance = ramp::Resonance{std::min(70.0, least_hz * random.between(100, 200) / 100),
                                         random.between(10, 100) / 1000.0};
  load.stage.backlash = 0;
  return load;
}

void tune_swinging_load_of(std::uint64_t seed, Tally& tally) {
  const auto load = swinging_load(seed);
  const auto& resonance = *load.stage.resonance;
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ": " + load.text() + ", resonance " +
               std::to_string(resonance.frequency_hz) + ", damping " +
               std::to_string(resonance.damping));
  Tuned tuned(load, seed, bowed_model);
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  const auto velocity = found->velocity.proposed / full_step;
  const auto acceleration = found->acceleration.proposed / full_step;
  ASSERT_TRUE(found->bow);
  const auto& bow = *found->bow;
  const auto jerk = to_pps3(bow.value).value / full_step;
  EXPECT_LT(load.truth.short_of_torque(velocity, acceleration, jerk), full_steps_unseen);
  EXPECT_GE(bow.value, 1);
  EXPECT_LE(bow.value, 11) << "no steeper than what was tried";
  EXPECT_LE(bow.swing, bow.swing_before);
  ++tally.all;
  if (bow.value != 11) {
    ++tally.other_bows;
    const double way = 2 * found->velocity.proposed;
    const auto settled = settled_s(*found, bow.value, way, resonance);
    EXPECT_LE(settled, 1.02 * settled_s(*found, 11, way, resonance));
    EXPECT_NEAR(bow.resonance->frequency_hz, resonance.frequency_hz, 0.05 * resonance.frequency_hz);
  }
  tuned.expect_left_as_it_was();
}

// 4 of 9 loads stand sooner with another bow. Among five there may be none.
TEST(TuningProperty, FindsABowWithWhichALoadStandsSooner) {
  tune_loads(tune_swinging_load_of, 5, [](const Tally& tally) {
    return tally.other_bows > 0 && tally.other_bows >= tally.all / 5;
  });
}

// ---- By a limit switch -------------------------------------------------------------------------

void tune_by_switch(std::uint64_t seed, Tally& tally) {
  Loads random(seed);
  auto load = random.any();
  auto& stage = load.stage;
  const bool is_left = random.one_in(2);
  stage.encoder.reset();
  // What hangs would fall unseen.
  stage.pull = 0;
  load.truth.torque.load = stage.load;
  constexpr auto beyond = static_cast<std::int32_t>(40 * full_step);
  if (is_left) {
    stage.left_switch = load.travel.least;
    load.travel.least -= beyond;
  } else {
    stage.right_switch = load.travel.greatest;
    load.travel.greatest += beyond;
  }
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ": " + load.text());
  Tuned tuned(load, seed);
  tuned.by_switch = is_left ? LimitSwitch::left : LimitSwitch::right;
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  ++tally.all;
  const auto speed = load.truth.greatest_speed();
  const auto velocity = found->velocity.limit / full_step;
  EXPECT_LT(velocity, load.truth.greatest_speed_unseen());
  tally.by_motor += found->velocity.limited_by == LimitedBy::motor ? 1 : 0;
  tally.far_velocities += is_far(found->velocity, speed) ? 1 : 0;
  const auto proposed = found->velocity.proposed / full_step;
  const auto at = found->acceleration.proposed / full_step;
  EXPECT_LT(load.truth.short_of_torque(proposed, at), full_steps_unseen) << proposed << ' ' << at;
  const auto least = std::max(least_current(load.truth, proposed, at), greatest_current / 4.0);
  EXPECT_GE(found->current.proposed, least - 8);
  tuned.expect_left_as_it_was();
}

// The motor limits nine of ten: the others have no room for more.
TEST(TuningProperty, FindsNearlyWhatTheLoadBearsByASwitch) {
  tune_loads(tune_by_switch, 5,
             [](const Tally& tally) { return is_near(tally) && 2 * tally.by_motor > tally.all; });
}

// On its way up it lost a part of a step, which it got back on its way down.
TEST(TuningProperty, TakesAPartOfALostStepForNoRatioOfTheEncoder) {
  Tally tally;
  tune_load_of(5057, tally);
}

}  // namespace
}  // namespace tmcl
