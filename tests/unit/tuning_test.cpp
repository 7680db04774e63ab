// An axis that is tuned: what is refused, what ends it, and what is left then. That it finds what a
// load bears is in tests/property/tuning_property_test.cpp.
#include "tmcl/tuning.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "support/rounds.hpp"
#include "support/verified_module.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
namespace ap = axis_parameter;

constexpr std::int32_t full_step = 256;

sim::StageSettings some_load() {
  sim::StageSettings stage;
  stage.load = 200;
  stage.inertia = 100'000;
  stage.corner_speed = 400;
  stage.torque_follows_current = true;
  stage.encoder = sim::EncoderSettings{10'000};
  return stage;
}

class TunedModule {
 public:
  explicit TunedModule(const sim::StageSettings& stage, std::string_view model = "TMCM-1276",
                       std::int32_t standby_current = 8)
      : model_(find_model(model)), module(*model_, {}, stage) {
    module.exchange_time = {2ms, 4ms};
    options.units = {"x", model_, initial_units(*model_)};
    if (model_->family == Family::tmc457) {
      set(ap::unit_mode, 1);
      options.units.module = ModuleUnits{};
    }
    set(ap::max_velocity, 200 * full_step);
    set(ap::max_acceleration, 1500 * full_step);
    set(number_of("smart_energy_hysteresis_start"), 2);
    set(number_of("standby_current"), standby_current);
    for (const auto parameter : tune_parameters(*model_))
      options.settings.push_back({parameter, module.get(parameter)});
    options.max_current = 255;
    options.travel = {-1000 * full_step, 1000 * full_step};
  }
  Result<Tuning> tune() { return module.run(verbs::tune({ModuleAddress{1}, 0}, options)); }
  Error error() {
    auto found = tune();
    EXPECT_FALSE(found);
    return found ? Error{} : std::move(found.error());
  }
  void expect_left_as_it_was() {
    module.pass(5s);
    EXPECT_EQ(module.get(ap::actual_velocity), 0);
    for (const auto& [parameter, value] : options.settings)
      EXPECT_EQ(module.get(parameter), value) << int{parameter};
  }
  sim::Place place() { return module.lone.module.stage(0).position(); }

 private:
  void set(std::uint8_t parameter, std::int32_t value) {
    module.lone.ask(Command::SAP, parameter, value);
  }

  const Model* model_;

 public:
  test::VerifiedModule module;
  TuneOptions options;
};

TEST(Tuning, ProposesLessThanHeldInAnOrderToBeSet) {
  TunedModule tuned(some_load());
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->lost_steps);
  EXPECT_EQ(found->velocity.limited_by, LimitedBy::motor);
  EXPECT_NEAR(found->velocity.proposed, found->velocity.limit / 1.2, 1);
  EXPECT_NEAR(found->acceleration.proposed, found->acceleration.limit / 1.2, 1);
  EXPECT_GT(found->current.proposed, found->current.limit);
  ASSERT_TRUE(found->threshold);
  for (const auto& [parameter, value] : found->settings)
    EXPECT_EQ(tuned.module.lone.ask(Command::SAP, parameter, value).status, Status::ok);
  EXPECT_NEAR(tuned.module.get(ap::max_velocity), found->velocity.proposed, 1);
  EXPECT_EQ(tuned.module.get(number_of("stallguard2_threshold")), *found->threshold);
}

TEST(Tuning, EndsWhereItBegan) {
  TunedModule tuned(some_load());
  ASSERT_TRUE(tuned.tune());
  tuned.expect_left_as_it_was();
  EXPECT_EQ(tuned.module.get(ap::actual_position), 0);
  EXPECT_NEAR(static_cast<double>(tuned.place()), 0, full_step);
}

TEST(Tuning, StaysWithinTheBoundsOfTheAxis) {
  TunedModule tuned({.encoder = sim::EncoderSettings{10'000}});
  tuned.options.greatest_velocity = PulsesPerSecond{400.0 * full_step};
  tuned.options.greatest_acceleration = PulsesPerSecond2{3000.0 * full_step};
  std::int32_t fastest = 0;
  std::int32_t most_current = 0;
  tuned.options.max_current = 160;
  tuned.module.after_each = [&] {
    fastest = std::max(fastest, std::abs(tuned.module.get(ap::actual_velocity)));
    most_current = std::max(most_current, tuned.module.get(number_of("max_current")));
  };
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->velocity.limited_by, LimitedBy::bounds);
  EXPECT_EQ(found->acceleration.limited_by, LimitedBy::bounds);
  EXPECT_NEAR(found->acceleration.limit, 3000.0 * full_step, 1);
  EXPECT_LE(fastest, 400 * full_step + 1);
  EXPECT_LE(most_current, 255) << "what it had";
  for (const auto& trial : found->trials) EXPECT_LE(trial.current, 160);
  EXPECT_FALSE(found->lost_steps);
  EXPECT_EQ(found->current.limit, 40) << "coolStep goes no lower than a quarter";
}

TEST(Tuning, SaysWhatTheTravelIsTooShortFor) {
  TunedModule tuned(some_load());
  tuned.options.travel = {0, 150 * full_step};
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->velocity.limited_by, LimitedBy::travel);
  EXPECT_THAT(found->warnings.front(), HasSubstr("the travel is too short"));
}

// Of 1000 it is drawn by 300, of which friction holds 50: 8 of 32 steps are enough.
sim::StageSettings hanging_load() {
  auto stage = some_load();
  stage.load = 50;
  stage.pull = 300;
  return stage;
}

TEST(Tuning, ProposesAStandbyCurrentWithWhichALoadThatHangsStands) {
  TunedModule tuned(hanging_load(), "TMCM-1276", 128);
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->hold_current);
  EXPECT_EQ(found->hold_current->limited_by, LimitedBy::motor);
  EXPECT_EQ(found->hold_current->limit, 64);
  EXPECT_EQ(found->hold_current->proposed, std::ceil(1.2 * 64));
  const auto is_hold = [](const plan::Setting& setting) { return setting.parameter == 7; };
  EXPECT_EQ(std::ranges::count_if(found->settings, is_hold), 1);
  const auto slid = [](const TuneTrial& one) { return one.sought == Sought::hold && !one.held; };
  EXPECT_EQ(std::ranges::count_if(found->trials, slid), 1) << "it slides only once";
  tuned.expect_left_as_it_was();
  EXPECT_NEAR(static_cast<double>(tuned.place()), 0, full_step);
}

TEST(Tuning, ProposesMoreStandbyCurrentWhereALoadSlidesWithWhatItHas) {
  TunedModule tuned(hanging_load(), "TMCM-1276", 40);
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->hold_current);
  EXPECT_EQ(found->hold_current->limit, 64);
}

TEST(Tuning, LeavesTheStandbyCurrentWhereNothingMovesTheAxis) {
  TunedModule tuned(some_load());
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->hold_current);
  EXPECT_EQ(found->hold_current->limited_by, LimitedBy::bounds);
  EXPECT_EQ(found->hold_current->limit, 0);
  EXPECT_EQ(found->hold_current->proposed, 8);
  for (const auto& setting : found->settings) EXPECT_NE(setting.parameter, 7);
}

// Its swing takes 1/8 s, and the ramps that it is given 0.2 s.
TEST(Tuning, ProposesABowWithWhichALoadThatSwingsStandsSooner) {
  sim::StageSettings stage;
  stage.encoder = sim::EncoderSettings{10'000};
  stage.resonance = ramp::Resonance{8, 0.03};
  TunedModule tuned(stage, "TMCM-142", 2);
  tuned.options.max_current = 15;
  tuned.options.greatest_velocity = PulsesPerSecond{400.0 * full_step};
  tuned.options.greatest_acceleration = PulsesPerSecond2{2000.0 * full_step};
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->bow);
  ASSERT_TRUE(found->bow->resonance);
  EXPECT_NEAR(found->bow->resonance->frequency_hz, 8, 0.2);
  EXPECT_NEAR(found->bow->resonance->damping, 0.03, 0.01);
  EXPECT_LT(found->bow->value, 6);
  EXPECT_LT(found->bow->swing, 0.3 * found->bow->swing_before);
  const plan::Setting proposed{number_of("max_bow"), found->bow->value};
  EXPECT_THAT(found->settings, testing::Contains(proposed));
  tuned.expect_left_as_it_was();
}

// With a bow its chip uses 15/16 of the deceleration, which is set to more for that.
TEST(Tuning, SetsNoDecelerationBeyondTheBoundsOfAnAxisWithABow) {
  TunedModule tuned({.encoder = sim::EncoderSettings{10'000}}, "TMCM-142", 2);
  const PulsesPerSecond2 bound{2000.0 * full_step};
  tuned.options.max_current = 15;
  tuned.options.greatest_velocity = PulsesPerSecond{400.0 * full_step};
  tuned.options.greatest_acceleration = bound;
  const auto most = to_internal(bound, *tuned.options.units.module).value().value;
  ASSERT_LT(tuned.module.get(17), most) << "max_deceleration";
  std::int32_t steepest = 0;
  tuned.module.after_each = [&] { steepest = std::max(steepest, tuned.module.get(17)); };
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->acceleration.limited_by, LimitedBy::bounds);
  EXPECT_NEAR(found->acceleration.limit, bound.value * 15 / 16, 0.001 * bound.value);
  EXPECT_LE(steepest, most);
}

TEST(Tuning, LeavesTheBowWhereNoLoadSwings) {
  TunedModule tuned({.encoder = sim::EncoderSettings{10'000}}, "TMCM-142", 2);
  tuned.options.max_current = 15;
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->bow);
  EXPECT_FALSE(found->bow->resonance);
  EXPECT_EQ(found->bow->value, 11);
  for (const auto& setting : found->settings) EXPECT_NE(setting.parameter, number_of("max_bow"));
}

TEST(Tuning, FindsNoBowWhereTheModuleHasNone) {
  TunedModule tuned(some_load());
  const auto found = tuned.tune();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->bow);
}

TEST(Tuning, NeedsAnEncoderThatFollows) {
  TunedModule none(some_load(), "TMCM-6110");
  EXPECT_EQ(none.error().code, Errc::bad_argument);
  auto stage = some_load();
  stage.encoder.reset();
  TunedModule unconnected(stage);
  EXPECT_THAT(unconnected.error().message, HasSubstr("the encoder has counted 0"));
  unconnected.expect_left_as_it_was();
  stage = some_load();
  stage.load = 1000;
  TunedModule held(stage);
  EXPECT_EQ(held.error().code, Errc::move_interrupted);
  held.expect_left_as_it_was();
}

// ---- By a limit switch -------------------------------------------------------------------------

sim::StageSettings load_with_switch(bool is_left) {
  auto stage = some_load();
  stage.encoder.reset();
  (is_left ? stage.left_switch : stage.right_switch) = (is_left ? -900 : 900) * full_step;
  return stage;
}

TEST(Tuning, SeesLostStepsByALimitSwitchWhereThereIsNoEncoder) {
  TunedModule by_encoder(some_load());
  const auto expected = by_encoder.tune();
  ASSERT_TRUE(expected);
  for (const bool is_left : {true, false}) {
    SCOPED_TRACE(is_left);
    TunedModule tuned(load_with_switch(is_left));
    tuned.options.by_switch = is_left ? LimitSwitch::left : LimitSwitch::right;
    const auto found = tuned.tune();
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->velocity.limited_by, LimitedBy::motor);
    EXPECT_NEAR(found->velocity.limit, expected->velocity.limit, 0.1 * expected->velocity.limit);
    EXPECT_NEAR(found->acceleration.limit, expected->acceleration.limit,
                0.1 * expected->acceleration.limit);
    EXPECT_NEAR(found->current.limit, expected->current.limit, 8);
    EXPECT_TRUE(found->threshold);
    EXPECT_TRUE(found->lost_steps);
    EXPECT_FALSE(found->hold_current);
    tuned.expect_left_as_it_was();
    EXPECT_NEAR(static_cast<double>(tuned.place()), 0, full_step);
  }
}

TEST(Tuning, ByASwitchStaysWithinTheTravelOnTheOtherSideAndPassesTheSwitchByLittle) {
  TunedModule tuned(load_with_switch(true));
  tuned.options.by_switch = LimitSwitch::left;
  sim::Place least = 0;
  sim::Place most = 0;
  tuned.module.after_each = [&] {
    least = std::min(least, tuned.place());
    most = std::max(most, tuned.place());
  };
  ASSERT_TRUE(tuned.tune());
  EXPECT_GE(least, -(900 + 8) * full_step);
  EXPECT_LE(most, tuned.options.travel.greatest);
}

TEST(Tuning, ByASwitchEndsOnItWhereItBeganThere) {
  auto stage = load_with_switch(true);
  stage.left_switch = 0;
  TunedModule tuned(stage);
  tuned.options.travel = {-20 * full_step, 1000 * full_step};
  tuned.options.by_switch = LimitSwitch::left;
  ASSERT_TRUE(tuned.tune());
  tuned.expect_left_as_it_was();
  EXPECT_NEAR(static_cast<double>(tuned.place()), 0, full_step);
}

TEST(Tuning, NeedsASwitchThatItReachesAndThatStopsIt) {
  auto stage = load_with_switch(true);
  TunedModule other(stage);
  other.options.by_switch = LimitSwitch::right;
  EXPECT_THAT(other.error().message, HasSubstr("right limit switch has not stopped the axis"));
  other.expect_left_as_it_was();
  TunedModule short_travel(stage);
  short_travel.options.by_switch = LimitSwitch::left;
  short_travel.options.travel = {-100 * full_step, 1000 * full_step};
  EXPECT_EQ(short_travel.error().code, Errc::bad_argument);
  TunedModule disabled(stage);
  constexpr std::uint8_t automatic_left_stop = 13;
  disabled.module.lone.ask(Command::SAP, automatic_left_stop, 0);
  disabled.options.by_switch = LimitSwitch::left;
  EXPECT_THAT(disabled.error().message, HasSubstr("has not stopped the axis"));
}

TEST(Tuning, ByASwitchGivesBackWhatItHasSetWhateverFails) {
  const auto tuned_with = [](std::optional<std::size_t> failing) {
    TunedModule tuned(load_with_switch(true));
    tuned.options.by_switch = LimitSwitch::left;
    tuned.module.failing = failing;
    (void)tuned.tune();
    tuned.expect_left_as_it_was();
    return tuned.module.exchanges();
  };
  const auto exchanges = tuned_with(std::nullopt);
  const auto stride = exchanges / static_cast<std::size_t>(test::rounds(6)) + 1;
  for (std::size_t step = 1; step < exchanges; step += stride) {
    SCOPED_TRACE(step);
    tuned_with(step);
    if (testing::Test::HasFailure()) break;
  }
}

TEST(Tuning, NeedsSomeTravel) {
  TunedModule tuned(some_load());
  tuned.options.travel = {0, 60 * full_step};
  EXPECT_THAT(tuned.error().message, HasSubstr("too short to tune by"));
}

// The motor stops within the time that it takes to see that its rotor has lost the field.
TEST(Tuning, EndsATrialAtTheFirstSignOfTrouble) {
  TunedModule tuned(some_load());
  double farthest = 0;
  tuned.module.after_each = [&] {
    const double position = tuned.module.get(ap::actual_position);
    farthest = std::max(farthest, std::abs(position - static_cast<double>(tuned.place())));
  };
  const auto found = tuned.tune();
  ASSERT_TRUE(found);
  int lost = 0;
  for (const auto& trial : found->trials) lost += trial.held ? 0 : 1;
  EXPECT_GT(lost, 3);
  const auto& limit = found->velocity.limit;
  const auto braking = 1.5 * 1.5 * limit * limit / (2 * 1500 * full_step);
  EXPECT_LT(farthest, braking + 0.1 * limit);
}

// Whatever fails once, before or after the module has seen it.
TEST(Tuning, StopsAndGivesBackWhatItHasSetWhateverFails) {
  TunedModule whole(some_load());
  ASSERT_TRUE(whole.tune());
  const auto exchanges = whole.module.exchanges();
  const auto stride = exchanges / static_cast<std::size_t>(test::rounds(6)) + 1;
  for (std::size_t step = 1; step < exchanges; step += stride) {
    for (const bool unseen : {false, true}) {
      SCOPED_TRACE(step);
      TunedModule tuned(some_load());
      tuned.module.failing = step;
      tuned.module.fails_unseen = unseen;
      (void)tuned.tune();
      tuned.expect_left_as_it_was();
    }
    if (testing::Test::HasFailure()) break;
  }
}

}  // namespace
}  // namespace tmcl
