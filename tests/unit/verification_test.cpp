// A module held against its twin: what is said of it, what is left of it when something fails, and
// the file about it.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "config/module_file.hpp"
#include "support/rounds.hpp"
#include "support/temp_path.hpp"
#include "support/verified_module.hpp"
#include "tmcl/parameter_number.hpp"
#include "tools/tmclsim/module_file.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
namespace ap = axis_parameter;

const Model& tmc429() { return *find_model("TMCM-1110"); }

const TraitFinding& of(const Verification& found, Trait trait) {
  return *std::ranges::find(found.traits, trait, &TraitFinding::trait);
}

TEST(Verification, SaysWhyItHasNotMeasuredWhatItCannot) {
  test::VerifiedModule module(tmc429(), {});
  const auto found = module.verify();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(to_string(found->version), "1.13");
  EXPECT_EQ(found->traits.size(), trait_count);
  for (const auto trait : {Trait::limit_stop, Trait::heartbeat, Trait::program_state}) {
    EXPECT_FALSE(of(*found, trait).measured);
    EXPECT_THAT(of(*found, trait).text, testing::Not(testing::IsEmpty()));
  }
}

TEST(Verification, ForeseesWhatTheModuleDoesIfItIsAsItsTwin) {
  test::VerifiedModule module(tmc429(), {});
  const auto found = module.verify();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GE(found->moves.size(), 2U);
  for (const auto& move : found->moves) {
    EXPECT_GE(move.foreseen, move.least - 40ms) << move.settings;
    EXPECT_LE(move.foreseen, move.most + 40ms) << move.settings;
  }
}

TEST(Verification, LeavesOutWhatDoesNotFitIntoTheTravelAndTheLimits) {
  test::VerifiedModule module(tmc429(), {});
  auto options = module.options();
  options.travel = {0, 1};
  const auto found = module.verify(options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->moves.empty());
  EXPECT_THAT(of(*found, Trait::last_step).text, HasSubstr("travel"));
  EXPECT_THAT(of(*found, Trait::relative_from).text, HasSubstr("travel"));
  EXPECT_TRUE(of(*found, Trait::range_check).measured);
  options.travel = {-100, 100};
  options.greatest_velocity = PulsesPerSecond{30};
  module.after_each = [&] {
    EXPECT_LE(to_pps(InternalVelocity{std::abs(module.get(ap::actual_velocity))},
                     module_units(Tmc429Dividers{
                         static_cast<std::uint8_t>(module.get(number_of("pulse_divisor"))), 0}))
                  .value,
              30);
  };
  EXPECT_TRUE(module.verify(options));
}

TEST(Verification, FindsWhereCommand135HasItsStateWhileAProgramRuns) {
  sim::ModuleSettings settings;
  settings.traits.set(Trait::program_state, ProgramState::low_byte);
  test::VerifiedModule module(tmc429(), settings);
  const auto ask = [&](Command command) { return module.lone.ask(command, 0, 0); };
  ask(Command::START_DOWNLOAD);
  module.lone.ask({ModuleAddress{1}, Command::JA, 0, 0, 0});
  ask(Command::END_DOWNLOAD);
  ask(Command::RUN_APPLICATION);
  const auto found = module.verify();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(of(*found, Trait::program_state).found(), index_of(ProgramState::low_byte));
  EXPECT_THAT(of(*found, Trait::order).text, HasSubstr("a program runs"));
  EXPECT_TRUE(found->moves.empty());
}

TEST(Verification, OfOtherFamiliesMeasuresWhatConcernsThem) {
  for (const auto* name : {"TMCM-1276", "TMCM-142", "TMCM-1316", "TMCM-1021"}) {
    SCOPED_TRACE(name);
    test::VerifiedModule module(*find_model(name), {});
    const auto options = module.options();
    const auto found = module.verify(options);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(of(*found, Trait::range_check).measured);
    EXPECT_TRUE(of(*found, Trait::relative_from).found()) << of(*found, Trait::relative_from).text;
    EXPECT_TRUE(of(*found, Trait::addressing).found());
    EXPECT_EQ(std::ranges::count(found->traits, Trait::order, &TraitFinding::trait), 0);
    for (const auto& [parameter, value] : options.settings) EXPECT_EQ(module.get(parameter), value);
  }
}

TEST(Verification, FindsWhatATargetDoesToAMotorThatTurnsByVelocity) {
  for (const auto* name : {"TMCM-1110", "TMCM-1276", "TMCM-142", "TMCM-1316"}) {
    for (const auto variant : {VelocityTarget::turns_on, VelocityTarget::goes_there}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(index_of(variant)));
      sim::ModuleSettings settings;
      settings.traits.set(Trait::velocity_target, variant);
      test::VerifiedModule module(*find_model(name), settings);
      auto options = module.options();
      const auto home = module.get(ap::actual_position);
      options.travel = {home - 80, home + 80};
      module.after_each = [&] { EXPECT_LE(std::abs(module.get(ap::actual_position) - home), 80); };
      const auto found = module.verify(options);
      ASSERT_TRUE(found) << found.error().message;
      EXPECT_EQ(of(*found, Trait::velocity_target).found(), index_of(variant))
          << of(*found, Trait::velocity_target).text;
      EXPECT_EQ(module.get(ap::actual_position), home);
      EXPECT_EQ(module.get(ap::actual_velocity), 0);
    }
  }
}

// Whatever fails once, before or after the module has seen it. Each failure is a course of its own,
// which computes for long: every day some steps all over it, in the nightly run every one.
TEST(Verification, StopsAndGivesBackWhatItHasSetWhateverFails) {
  sim::ModuleSettings settings;
  settings.traits.set(Trait::last_step, ramp::Tmc429::LastStep::r2);
  settings.traits.set(Trait::range_check, RangeCheck::wrap);
  test::VerifiedModule whole(tmc429(), settings);
  auto slow = [](test::VerifiedModule& module) { module.exchange_time = {20ms, 25ms}; };
  slow(whole);
  ASSERT_TRUE(whole.verify());
  const auto stride =
      std::max<std::size_t>(1, whole.exchanges() / static_cast<std::size_t>(test::rounds(12)));
  for (std::size_t step = 0; step < whole.exchanges(); step += stride) {
    for (const bool unseen : {false, true}) {
      SCOPED_TRACE(step);
      test::VerifiedModule module(tmc429(), settings);
      slow(module);
      const auto options = module.options();
      module.failing = step;
      module.fails_unseen = unseen;
      const auto found = module.verify(options);
      module.pass(1s);
      EXPECT_EQ(module.get(ap::actual_velocity), 0);
      EXPECT_LE(std::abs(module.get(ap::actual_position)), 100);
      for (const auto& [parameter, value] : options.settings)
        EXPECT_EQ(module.get(parameter), value) << int{parameter};
    }
    if (HasFailure()) break;
  }
}

TEST(Verification, StopsAMotorThatDoesNotArrive) {
  sim::StageSettings stage;
  stage.right_switch = 1;
  test::VerifiedModule module(tmc429(), {}, stage);
  const auto found = module.verify();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Errc::move_interrupted);
  EXPECT_THAT(found.error().message, HasSubstr("was sent from 0 to"));
}

// ---- the file ---------------------------------------------------------------------------------

TEST(VerificationReport, IsWhatASimulatedModuleAndATwinTake) {
  sim::ModuleSettings settings;
  settings.traits.set(Trait::last_step, ramp::Tmc429::LastStep::r1);
  settings.traits.set(Trait::accumulator, ramp::Tmc429::Accumulator::kept);
  settings.traits.set(Trait::relative_answer, RelativeAnswer::target);
  test::VerifiedModule module(tmc429(), settings);
  const auto found = module.verify();
  ASSERT_TRUE(found) << found.error().message;
  const auto report = report_of(*found, "axis 'x'");
  const auto simulated = tmclsim::parse_module_file(report, "x.toml", tmc429());
  ASSERT_TRUE(simulated) << simulated.error();
  EXPECT_EQ(simulated->traits, found->found());
  EXPECT_EQ(simulated->to_answer, std::chrono::floor<std::chrono::microseconds>(*found->answer));
  EXPECT_THAT(report, HasSubstr("foreseen was r3"));
  const auto file = test::temp_path("verified.toml");
  std::ofstream(file) << report;
  const auto twin = tmcld::read_measured_module(file);
  ASSERT_TRUE(twin) << twin.error();
  EXPECT_EQ(twin->model, &tmc429());
  EXPECT_EQ(twin->traits, found->found());
}

TEST(VerificationReport, NamesLineAndNearestWordOfWhatIsWrong) {
  const auto file = test::temp_path("wrong.toml");
  std::ofstream(file) << "[module]\nmodel = \"TMCM-1110\"\nlast_step = \"r4\"\n";
  const auto read = tmcld::read_measured_module(file);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error(), HasSubstr(":3: 'last_step' is 'r4', but must be r3, r1 or r2."));
}

}  // namespace
}  // namespace tmcl
