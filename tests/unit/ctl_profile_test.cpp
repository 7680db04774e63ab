// profile simulate: generators that are easy to foresee, and the words of the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>

#include <fmt/format.h>

#include "command_line/options.hpp"
#include "profile/player.hpp"
#include "profile/setup.hpp"
#include "support/build_paths.hpp"
#include "support/seed.hpp"
#include "support/temp_path.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::profile {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tmcl::ramp::Finding;
using tmcl::ramp::RegisterError;
using tmcl::ramp::RegisterInfo;

/// Goes to its target at a constant speed. Its gear keeps at standstill only, and it has moods.
struct Plodder {
  enum class Register : std::uint8_t { speed, target, gear, mood };
  static constexpr std::string_view chip = "plodder";
  static double ticks_per_second(double) { return 10; }
  static std::span<const RegisterInfo> registers() {
    static constexpr RegisterInfo rows[] = {{"speed", 0, 10, "steps per tick"},
                                            {"target", -1000, 1000, "steps"},
                                            {"gear", 0, 5, ""},
                                            {"mood", 0, 2, "0: good, 1 and 2: bad"}};
    return rows;
  }

  tmcl::ramp::Written write(Register name, std::int64_t value) {
    const auto i = static_cast<std::size_t>(name);
    const auto& info = registers()[i];
    if (value < info.minimum || value > info.maximum)
      return tl::unexpected(RegisterError{RegisterError::Reason::out_of_range, &info, value});
    if (name == Register::gear && !settled())
      return tl::unexpected(RegisterError{RegisterError::Reason::in_motion, &info, value});
    values[i] = value;
    return {};
  }
  std::int64_t read(Register name) const { return values[static_cast<std::size_t>(name)]; }
  std::vector<Finding> findings() const {
    if (values[3] == 0) return {};
    return {{"{} is bad", {{3, values[3], Finding::Form::name_and_value}}}};
  }

  Tick tick() const { return now; }
  void advance_to(Tick tick) {
    if (tick <= now) return;
    const auto way = values[1] - position;
    const auto most = values[0] * static_cast<std::int64_t>(std::min<Tick>(tick - now, 10'000));
    position += std::clamp(way, -most, most);
    now = tick;
  }
  Motion motion() const {
    return {position, settled() ? 0 : (values[1] > position ? values[0] : -values[0]), 0};
  }
  std::string_view phase() const { return settled() ? "rest" : "go"; }
  Tick next_change() const {
    if (settled()) return tmcl::ramp::forever;
    return now + static_cast<Tick>((std::abs(values[1] - position) + values[0] - 1) / values[0]);
  }
  bool arrived() const { return position == values[1]; }
  bool settled() const { return arrived() || values[0] == 0; }
  bool operator==(const Plodder&) const = default;

  Tick now = 0;
  std::int64_t position = 0;
  std::array<std::int64_t, 4> values{};
};
static_assert(tmcl::ramp::Generator<Plodder>);

/// Its speed rises from 0 by 1 a tick and falls back to 0 every ten ticks, for ever.
struct Sawtooth {
  enum class Register : std::uint8_t {};
  static constexpr Tick period = 10;
  static constexpr std::string_view chip = "sawtooth";
  static double ticks_per_second(double) { return 1; }
  static std::span<const RegisterInfo> registers() { return {}; }
  tmcl::ramp::Written write(Register, std::int64_t) { return {}; }
  std::int64_t read(Register) const { return 0; }
  std::vector<Finding> findings() const { return {}; }
  Tick tick() const { return now; }
  void advance_to(Tick tick) { now = std::max(now, tick); }
  Motion motion() const { return {0, -static_cast<std::int64_t>(now % period), -1}; }
  std::string_view phase() const { return now / period % 2 == 0 ? "even" : "odd"; }
  Tick next_change() const { return (now / period + 1) * period; }
  bool arrived() const { return false; }
  bool settled() const { return false; }
  bool operator==(const Sawtooth&) const = default;

  Tick now = 0;
};
static_assert(tmcl::ramp::Generator<Sawtooth>);

Write speed(std::int64_t value) { return {0, value, "speed"}; }
Write target(std::int64_t value) { return {1, value, "target"}; }
Write gear(std::int64_t value) { return {2, value, "gear"}; }
Write mood(std::int64_t value) { return {3, value, "mood"}; }

Outcome follow(const Script& script, std::optional<Tick> until = std::nullopt) {
  return SimulationOf<Plodder>(script).follow(until).value();
}

std::vector<std::string> phases_of(const Outcome& outcome) {
  std::vector<std::string> phases;
  for (const auto& phase : outcome.phases)
    phases.push_back(phase.name + '@' + std::to_string(phase.tick));
  return phases;
}

TEST(ProfilePlayer, FollowsAMoveToItsEnd) {
  const auto outcome = follow({{speed(10), target(-95)}, {}});
  EXPECT_EQ(outcome.arrival, 10U);
  EXPECT_EQ(outcome.end, 10U);
  EXPECT_EQ(outcome.at_end, (Motion{-95, 0, 0}));
  EXPECT_EQ(outcome.peak_velocity, 10);
  EXPECT_THAT(phases_of(outcome), ElementsAre("go@0"));
  EXPECT_FALSE(outcome.cut_off);
}

TEST(ProfilePlayer, NothingToDoIsDoneAtOnce) {
  const auto outcome = follow({});
  EXPECT_EQ(outcome.arrival, 0U);
  EXPECT_EQ(outcome.end, 0U);
  EXPECT_THAT(outcome.phases, IsEmpty());
}

TEST(ProfilePlayer, ChangesActAfterTheirTick) {
  const Script script{{speed(10), target(100)}, {{4, target(0)}, {30, target(20)}}};
  const auto outcome = follow(script);
  EXPECT_EQ(outcome.arrival, 32U);
  EXPECT_THAT(phases_of(outcome), ElementsAre("go@0", "rest@8", "go@30"));
  const std::vector<Tick> ticks{0, 3, 4, 4, 5, 8, 31, 1000};
  std::vector<std::int64_t> positions;
  const auto motions = SimulationOf<Plodder>(script).motions_at(ticks);
  for (const auto& motion : motions.value()) positions.push_back(motion.position);
  EXPECT_THAT(positions, ElementsAre(0, 30, 40, 40, 30, 0, 10, 20));
}

TEST(ProfilePlayer, TheLastOfEqualTimesCounts) {
  EXPECT_EQ(follow({{speed(10)}, {{4, target(50)}, {4, target(70)}}}).at_end.position, 70);
}

TEST(ProfilePlayer, AWriteAfterTheArrivalDoesNotDelayIt) {
  const auto outcome = follow({{speed(10), target(100)}, {{50, speed(1)}}});
  EXPECT_EQ(outcome.arrival, 10U);
  EXPECT_EQ(outcome.end, 50U);
}

TEST(ProfilePlayer, WhatStopsShortDoesNotArrive) {
  const auto outcome = follow({{speed(10), target(100)}, {{3, speed(0)}}});
  EXPECT_EQ(outcome.arrival, std::nullopt);
  EXPECT_EQ(outcome.end, 3U);
  EXPECT_EQ(outcome.at_end.position, 30);
}

TEST(ProfilePlayer, EndsWhereItIsToldTo) {
  const Script script{{speed(10), target(100)}, {}};
  EXPECT_EQ(follow(script, 4).arrival, std::nullopt);
  EXPECT_EQ(follow(script, 4).at_end.position, 40);
  EXPECT_EQ(follow(script, 0).end, 0U);
  EXPECT_EQ(follow(script, 100).end, 100U);
  EXPECT_EQ(follow(script, 100).arrival, 10U);
}

TEST(ProfilePlayer, SaysWhichWriteWasRefused) {
  const auto refused = [](const Script& script) {
    return SimulationOf<Plodder>(script).follow(std::nullopt).error().message;
  };
  EXPECT_EQ(refused({{target(1001)}, {}}), "target: target is -1000..1000, not 1001");
  EXPECT_EQ(refused({{}, {{2, speed(11)}}}), "speed: speed is 0..10, not 11");
  const Script in_motion{{speed(1), target(10)}, {{5, gear(1)}}};
  EXPECT_EQ(refused(in_motion), "gear: gear cannot be changed in motion");
  const std::array<Tick, 1> later{7};
  EXPECT_FALSE(SimulationOf<Plodder>(in_motion).motions_at(later));
  EXPECT_EQ(follow({{speed(1), target(10)}, {{10, gear(1)}}}).arrival, 10U) << "at rest it may";
}

TEST(ProfilePlayer, JudgesWhatIsWrittenTogether) {
  EXPECT_THAT(follow({{mood(2)}, {{0, mood(0)}}}).warnings, IsEmpty());
  EXPECT_THAT(
      follow({{mood(1)}, {{3, speed(1)}, {5, mood(0)}, {6, mood(1)}, {7, mood(2)}}}).warnings,
      ElementsAre("mood 1 is bad", "mood 2 is bad"));
}

TEST(ProfilePlayer, FindsThePeakJustBeforeAChange) {
  EXPECT_EQ(SimulationOf<Sawtooth>({}).follow(25).value().peak_velocity, 9);
  EXPECT_EQ(SimulationOf<Sawtooth>({}).follow(6).value().peak_velocity, 6);
}

TEST(ProfilePlayer, WhatNeverEndsIsCutOff) {
  const SimulationOf<Sawtooth> endless({}, 100);
  const auto outcome = endless.follow(std::nullopt).value();
  EXPECT_TRUE(outcome.cut_off);
  EXPECT_EQ(outcome.end, 1000U);
  EXPECT_EQ(outcome.phases.size(), 101U);
  const std::vector<Tick> within{10, 500, 1000};
  EXPECT_TRUE(endless.motions_at(within));
  const std::vector<Tick> beyond{1'000'000'000};
  EXPECT_THAT(endless.motions_at(beyond).error().message, HasSubstr("more than 100 times"));
}

TEST(ProfilePlayer, ListsABoundedNumberOfPhases) {
  const auto outcome = SimulationOf<Sawtooth>({}, 3 * most_phases).follow(std::nullopt).value();
  EXPECT_EQ(outcome.phases.size(), most_phases);
  EXPECT_TRUE(outcome.more_phases);
}

/// One tick after the other.
Outcome plod(const Script& script, Tick until) {
  Plodder plodder;
  Outcome outcome;
  std::string_view phase;
  for (const auto& write : script.start)
    EXPECT_TRUE(plodder.write(Plodder::Register(write.index), write.value));
  for (Tick tick = 0; tick <= until; ++tick) {
    plodder.advance_to(tick);
    for (const auto& change : script.changes) {
      if (change.tick != tick) continue;
      EXPECT_TRUE(plodder.write(Plodder::Register(change.write.index), change.write.value));
    }
    outcome.peak_velocity = std::max(outcome.peak_velocity, std::abs(plodder.motion().velocity));
    if (!plodder.arrived()) outcome.arrival.reset();
    if (plodder.arrived() && !outcome.arrival) outcome.arrival = tick;
    if (plodder.phase() != phase) outcome.phases.push_back({std::string(plodder.phase()), tick});
    phase = plodder.phase();
  }
  if (phase == "rest") outcome.phases.pop_back();
  const bool starts_late = outcome.phases.size() > 1 && outcome.phases[1].tick == 1;
  if (starts_late && outcome.phases[0].name == "rest") {
    outcome.phases.erase(outcome.phases.begin());
    outcome.phases[0].tick = 0;
  }
  outcome.at_end = plodder.motion();
  return outcome;
}

TEST(ProfilePlayer, AgreesWithTickingThroughAnyScript) {
  const auto first = tmcl::test::seed();
  int arrived = 0;
  for (auto seed = first; seed < first + 2000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    std::mt19937_64 random(seed);
    const auto pick = [&](std::int64_t low, std::int64_t high) {
      return std::uniform_int_distribution<std::int64_t>(low, high)(random);
    };
    Script script{{speed(pick(0, 10)), target(pick(-200, 200))}, {}};
    for (auto n = pick(0, 4); n > 0; --n) {
      const auto tick = static_cast<Tick>(pick(0, 150));
      script.changes.push_back(
          {tick, pick(0, 1) == 0 ? speed(pick(0, 10)) : target(pick(-200, 200))});
    }
    std::ranges::stable_sort(script.changes, {}, &Change::tick);
    const Tick until = 600;
    const auto expected = plod(script, until);
    const auto outcome = follow(script, until);
    ASSERT_EQ(outcome.arrival, expected.arrival);
    ASSERT_EQ(outcome.at_end, expected.at_end);
    ASSERT_EQ(outcome.peak_velocity, expected.peak_velocity);
    ASSERT_EQ(phases_of(outcome), phases_of(expected));
    // Without an end it is the same, unless it would have to wait for what does not come.
    const auto free = follow(script);
    ASSERT_EQ(free.arrival, expected.arrival);
    ASSERT_EQ(free.at_end.position, expected.at_end.position);
    arrived += outcome.arrival ? 1 : 0;
  }
  EXPECT_GT(arrived, 1000);
}

std::string information(const std::vector<std::string>& words) {
  return std::get<Information>(parse_options(words).value()).text;
}

class CtlProfile : public testing::Test, public test::CtlBench {
 protected:
  using Words = std::vector<std::string>;

  static Words simulate(const Words& words) {
    Words all{"profile", "simulate"};
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  static Words move_429(const Words& more = {}) {
    Words all{"--generator", "tmc429",     "v_max=1000",    "a_max=500",
              "pulse_div=2", "ramp_div=3", "x_target=20000"};
    all.insert(all.end(), more.begin(), more.end());
    return simulate(all);
  }
  /// What is said of a command line that is wrong.
  std::string complaint(const Words& words) {
    EXPECT_EQ(run(words), ExitCode::usage) << out;
    EXPECT_EQ(out, "");
    return err;
  }
  boost::json::object simulated(const Words& words) { return json(simulate(words)); }
};

tmcl::ramp::Tmc429 written_429() {
  using tmcl::ramp::Tmc429;
  Tmc429 generator;
  EXPECT_TRUE(generator.write(Tmc429::Register::v_min, 1));
  EXPECT_TRUE(generator.write(Tmc429::Register::v_max, 1000));
  EXPECT_TRUE(generator.write(Tmc429::Register::pulse_div, 2));
  EXPECT_TRUE(generator.write(Tmc429::Register::ramp_div, 3));
  EXPECT_TRUE(generator.write(Tmc429::Register::a_max, 500));
  EXPECT_TRUE(generator.write(Tmc429::Register::x_target, 20000));
  return generator;
}

TEST_F(CtlProfile, SaysWhatTheGeneratorDoes) {
  const auto document = json(move_429({"--sample", "0.2,0.1,0.1,5"}));
  auto generator = written_429();
  const auto arrival = tmcl::ramp::arrival(generator, tmcl::ramp::forever).value();
  EXPECT_EQ(document.at("generator"), "tmc429");
  EXPECT_EQ(document.at("duration_s").to_number<double>(), static_cast<double>(arrival) / 500'000);
  EXPECT_EQ(document.at("final_position"), 20000);
  EXPECT_EQ(document.at("peak_velocity"), 1000);
  generator.advance_to(50'000);
  const auto& samples = document.at("samples").as_array();
  ASSERT_EQ(samples.size(), 4U);
  const boost::json::object at_0_1{{"t", 0.1},
                                   {"x", generator.motion().position},
                                   {"v", generator.motion().velocity},
                                   {"a", generator.motion().acceleration}};
  EXPECT_EQ(samples[1], at_0_1);
  EXPECT_EQ(samples[2], at_0_1);
  EXPECT_EQ(samples[0].at("t"), 0.2);
  EXPECT_EQ(samples[3].at("x"), 20000);
  EXPECT_EQ(err, "");
}

TEST_F(CtlProfile, NamesThePhasesInTurn) {
  const auto phases = json(move_429()).at("phases").as_array();
  ASSERT_EQ(phases.size(), 3U);
  EXPECT_EQ(phases[0].at("name"), "accelerate");
  EXPECT_EQ(phases[0].at("start_s"), 0);
  EXPECT_EQ(phases[1].at("name"), "cruise");
  EXPECT_EQ(phases[2].at("name"), "decelerate");
  EXPECT_GT(phases[2].at("start_s").to_number<double>(),
            phases[1].at("start_s").to_number<double>());
}

TEST_F(CtlProfile, ChangesMayComeInAnyOrder) {
  const auto sorted =
      json(move_429({"--change", "0.1:x_target=-500", "--change", "0.2:x_target=30000"}));
  EXPECT_EQ(sorted.at("final_position"), 30000);
  EXPECT_EQ(json(move_429({"--change", "0.2:x_target=30000", "--change", "0.1:x_target=-500"})),
            sorted);
  EXPECT_EQ(json(move_429({"--change", "0:x_target=-1", "--change", "0:x_target=0x10"}))
                .at("final_position"),
            16);
  EXPECT_EQ(json(move_429({"--change", "5e-7:x_target=7", "--change", "4e-7:x_target=8"}))
                .at("final_position"),
            7)
      << "within one tick the times still count";
}

TEST_F(CtlProfile, TheOrderOfTheRegistersDoesNotMatter) {
  const auto expected = simulated({"--generator", "tmc429", "mode=velocity", "v_target=-700",
                                   "v_max=2047", "a_max=100", "pulse_div=3", "ramp_div=5"});
  EXPECT_EQ(expected.at("peak_velocity"), 700);
  EXPECT_EQ(expected.at("duration_s"), nullptr) << "it turns without end";
  EXPECT_EQ(simulated({"ramp_div=5", "pulse_div=3", "v_target=-700", "a_max=100", "v_max=2047",
                       "mode=2", "--generator", "tmc429"}),
            expected);
  EXPECT_EQ(simulated({"--generator", "tmc429", "v_actual=-300", "mode=hold", "--until", "1"})
                .at("peak_velocity"),
            300);
}

TEST_F(CtlProfile, ValuesHaveNamesAndMayBeHexadecimal) {
  const auto move = [this](const std::string& mode) {
    return simulated({"--generator", "tmc429", "v_max=0x3E8", "a_max=500", "pulse_div=2",
                      "ramp_div=3", "x_target=-0x64", mode});
  };
  EXPECT_EQ(move("mode=ramp").at("final_position"), -100);
  EXPECT_EQ(move("mode=soft"), move("mode=1"));
  EXPECT_NE(move("mode=soft"), move("mode=ramp"));
  EXPECT_NE(move("last_step=r1"), move("last_step=r3"));
}

TEST_F(CtlProfile, TheClockSetsThePace) {
  const auto at = [this](const std::string& clock) {
    return json(move_429({clock})).at("duration_s").to_number<double>();
  };
  EXPECT_DOUBLE_EQ(at("f_clk=8e6"), 2 * at("f_clk=16000000"));
  EXPECT_EQ(json(move_429()).at("duration_s").to_number<double>(), at("f_clk=16000000"));
}

TEST_F(CtlProfile, SomeRegistersAreNotLeftAsAtPowerUp) {
  EXPECT_EQ(json(move_429({"v_min=1"})), json(move_429()));
  EXPECT_EQ(run(move_429({"v_min=0"})), ExitCode::done);
  EXPECT_THAT(err, HasSubstr("warning: v_min 0: the motor may stop short"))
      << "a warning leaves standard output alone";
  EXPECT_THAT(out, Not(HasSubstr("warning")));
}

TEST_F(CtlProfile, EndsAtUntil) {
  const auto document = json(move_429({"--until", "0.1", "--sample", "0.1"}));
  EXPECT_EQ(document.at("duration_s"), nullptr);
  EXPECT_EQ(document.at("final_position"), document.at("samples").at(0).at("x"));
  EXPECT_EQ(run(move_429({"--until", "0.1", "--change", "1:v_max=5"})), ExitCode::done);
  EXPECT_THAT(err, HasSubstr("--change 1:v_max=5 comes after --until 0.1"));
}

TEST_F(CtlProfile, NoMotionIsNoError) {
  const auto document = json(move_429({"--change", "0:v_max=0"}));
  EXPECT_EQ(document.at("duration_s"), nullptr);
  EXPECT_EQ(document.at("final_position"), 0);
  EXPECT_THAT(document.at("phases").as_array(), IsEmpty());
}

// The last segment of AN-035: it starts with the speed of the one before, and ends slowly.
TEST_F(CtlProfile, ALastSegmentMayEndSlowerThanItStarts) {
  const Words segments{"--generator",        "sixpoint",         "v1=0",
                       "vstart=0",           "vstop=50000",      "vmax=100000",
                       "amax=1000",          "dmax=1000",        "xtarget=100000",
                       "--change",           "1.5:vstart=50000", "--change",
                       "1.5:xtarget=200000", "--change",         "1.5:vstop=10"};
  const auto document = simulated(segments);
  EXPECT_EQ(document.at("final_position"), 200'000);
  EXPECT_THAT(err, HasSubstr("warning: vstop 10 is below vstart 50000, so a short way"));
  EXPECT_TRUE(document.at("duration_s").is_double());
}

/// What a module takes with a warning is simulated with the same one.
TEST_F(CtlProfile, WhatAChipTakesIsAWarningAndNoError) {
  const auto warning_of = [this](const Words& settings) {
    Words all{"--generator", "sixpoint", "vmax=10000", "amax=100", "dmax=100", "xtarget=1000"};
    for (const auto& setting : settings) {
      std::erase_if(all, [&](const auto& word) {
        return word.substr(0, word.find('=')) == setting.substr(0, setting.find('='));
      });
      all.push_back(setting);
    }
    EXPECT_EQ(run(simulate(all)), ExitCode::done) << err;
    return err;
  };
  EXPECT_THAT(warning_of({"amax=0"}), HasSubstr("warning: amax 0 cannot change the velocity"));
  EXPECT_THAT(warning_of({"dmax=0"}), HasSubstr("warning: dmax 0 cannot brake"));
  EXPECT_THAT(warning_of({"vstop=9"}), HasSubstr("warning: vstop 9 is below 10"));
  EXPECT_THAT(warning_of({"vstart=20000", "vstop=20000"}),
              HasSubstr("warning: vmax 10000 is below vstart 20000"));
}

TEST_F(CtlProfile, OfARegisterThatIsTwoAndThoseTheLaterCounts) {
  const auto move = [this](const Words& settings) {
    Words all{"--generator", "tmc457", "v_max=5000000", "x_target=200000"};
    all.insert(all.end(), settings.begin(), settings.end());
    return simulated(all);
  };
  EXPECT_EQ(move({"a_max=24624", "d_max=24624", "a_max_d_max=500"}), move({"a_max_d_max=500"}));
  EXPECT_EQ(move({"a_max=500", "d_max=24624"}), move({"a_max_d_max=500", "d_max=24624"}));
  EXPECT_NE(move({"a_max=24624", "a_max_d_max=500"}), move({"a_max_d_max=500", "a_max=24624"}));
  EXPECT_THAT(information({"profile", "simulate", "--help"}), HasSubstr("a_max_d_max"));
}

TEST_F(CtlProfile, TimesInCyclesAreCalledSo) {
  const auto document = simulated({"--generator", "mc1451a", "velocity=1", "acceleration=11469",
                                   "jerk=32212255", "position=10"});
  EXPECT_EQ(document.at("duration_s"), document.at("duration_cycles")) << "as it was";
  EXPECT_FALSE(json(move_429()).contains("duration_cycles"));
  EXPECT_NEAR(document.at("duration_cycles").to_number<double>(), 655'360.1, 0.1);
  EXPECT_TRUE(document.at("ramp_up").as_object().contains("duration_cycles"));
  EXPECT_TRUE(document.at("ramp_down").as_object().contains("duration_cycles"));
  std::string names;
  for (const auto& phase : document.at("phases").as_array()) {
    EXPECT_TRUE(phase.as_object().contains("start_cycles"));
    names += std::string(phase.at("name").as_string()) + ' ';
  }
  EXPECT_EQ(names, "I III IV V VII ");
}

// ---- by the parameters of a module

TEST_F(CtlProfile, AModelIsSimulatedByItsParameters) {
  const auto document =
      simulated({"--model", "TMCM-142", "--screw-pitch", "5", "max_velocity=20mm/s", "5=500mm/s^2",
                 "max_bow=0", "x_target=150mm"});
  EXPECT_EQ(document.at("generator"), "tmc457");
  EXPECT_EQ(document.at("final_position"), 1'536'000);
  EXPECT_NEAR(document.at("duration_s").to_number<double>(), 150. / 20 + 20. / 500, 0.001);
  EXPECT_EQ(document.at("peak_velocity"), 13'743'895);
  const auto& velocity = document.at("parameters").at(0);
  EXPECT_EQ(velocity.at("parameter"), "max_velocity");
  EXPECT_EQ(velocity.at("number"), 4);
  EXPECT_EQ(velocity.at("said"), "20mm/s");
  EXPECT_EQ(velocity.at("register"), "v_max");
  EXPECT_EQ(velocity.at("holds"), 13'743'895);
  EXPECT_NEAR(velocity.at("deviation").to_number<double>(), 0, 1e-7);
  EXPECT_EQ(err, "");
}

TEST_F(CtlProfile, AModelOfEveryFamilyArrives) {
  for (const auto* model : {"TMCM-1110", "TMCM-142", "TMCM-6212", "TMCM-1111"}) {
    SCOPED_TRACE(model);
    const auto document = simulated(
        {"--model", model, "--microsteps", "64", "max_velocity=1rps", "target_position=3rev"});
    EXPECT_EQ(document.at("final_position"), 38'400);
    EXPECT_GT(document.at("duration_s").to_number<double>(), 2.99);
    EXPECT_LT(document.at("duration_s").to_number<double>(), 4);
    const auto turning = simulated(
        {"--model", model, "--microsteps", "64", "target_velocity=-30rpm", "--until", "2"});
    EXPECT_NEAR(turning.at("final_position").to_number<double>(), -12'800, 700);
  }
}

TEST_F(CtlProfile, OfAModelValuesCountAsTheModuleDoes) {
  const auto bare = [this](const Words& settings) {
    Words all{"--model", "TMCM-142", "--screw-pitch", "5"};
    all.insert(all.end(), settings.begin(), settings.end());
    return simulated(all).at("parameters");
  };
  EXPECT_EQ(bare({"max_velocity=1000", "0=5"}).at(0).at("holds"), 1000);
  EXPECT_EQ(bare({"max_velocity=1000", "unit_mode=1", "0=5"}).at(1).at("holds"), 67'108)
      << "what it is counted in comes first";
  const auto divided = simulated({"--model", "TMCM-1110", "max_velocity=1000pps", "154=5", "0=9"});
  EXPECT_EQ(divided.at("parameters").at(1).at("holds"), 131) << "of 7.63 pps";
}

TEST_F(CtlProfile, WarningsAboutAModelNameParametersAsTheyWereTyped) {
  EXPECT_EQ(run(simulate({"--model", "TMCM-6212", "--screw-pitch", "5", "start_velocity=4mm/s",
                          "target_position=10mm"})),
            ExitCode::done);
  EXPECT_THAT(err, HasSubstr("stop_velocity 10 is below start_velocity 4mm/s, so a short way"));
  EXPECT_EQ(run(simulate({"--model", "TMCM-6212", "velocity_v1=0", "18=1", "0=1000"})),
            ExitCode::done);
  EXPECT_THAT(err, HasSubstr("deceleration_d1 1 (0 in the chip) is not to be set"));
}

TEST_F(CtlProfile, NamesWhatIsWrongWithAParameter) {
  const auto said = [this](const Words& settings) {
    Words all{"--model", "TMCM-6212", "--screw-pitch", "5"};
    all.insert(all.end(), settings.begin(), settings.end());
    return complaint(simulate(all));
  };
  EXPECT_THAT(said({"max_velocty=1"}), HasSubstr("Did you mean 'max_velocity'?"));
  EXPECT_THAT(said({"max_acceleration=800mm/s^2"}),
              HasSubstr("max_acceleration=800mm/s^2: 800 mm/s^2 is too large; the nearest"));
  EXPECT_THAT(err, HasSubstr("parameter 140 set to 7"));
  EXPECT_THAT(said({"max_velocity=99999999"}), HasSubstr("max_velocity (4) is 0 to 7999511"));
  EXPECT_THAT(said({"run_current=5"}), HasSubstr("is in no register of the ramp generator"));
  EXPECT_THAT(said({"max_velocity=1", "4=2"}), HasSubstr("max_velocity is given twice"));
  EXPECT_THAT(said({"max_velocity"}), HasSubstr("is no PARAMETER=VALUE"));
  EXPECT_THAT(complaint(simulate({"--model", "TMCM-1021", "0=1000"})),
              HasSubstr("the firmware of a TMCM-1021 makes its ramps"));
  EXPECT_THAT(complaint(simulate({"0=1000"})), HasSubstr("give --generator or --model"));
}

TEST_F(CtlProfile, CsvHasARowForEveryStep) {
  EXPECT_EQ(run(move_429({"--csv", "0.125", "--until", "0.25"})), ExitCode::done);
  auto generator = written_429();
  std::string expected = "t,x,v,a\n";
  for (const auto* time : {"0", "0.125", "0.25"}) {
    generator.advance_to(static_cast<Tick>(std::stod(time) * 500'000));
    const auto motion = generator.motion();
    expected +=
        fmt::format("{},{},{},{}\n", time, motion.position, motion.velocity, motion.acceleration);
  }
  EXPECT_EQ(out, expected);
  EXPECT_EQ(run(move_429({"--csv", "0.3"})), ExitCode::done);
  EXPECT_TRUE(out.ends_with("\n0.6,20000,0,0\n")) << "the last one is at rest: " << out;
}

TEST_F(CtlProfile, DrawsOnTheScreenAndIntoFiles) {
  EXPECT_EQ(run(move_429()), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("tmc429 went from 0 to 20000 microsteps in 0.34 s, fastest velocity "
                             "1000 [internal]\n"));
  EXPECT_THAT(out, HasSubstr("velocity [internal]"));
  const std::filesystem::path path = tmcl::test::temp_path("ctl_profile_test.svg");
  EXPECT_EQ(run(move_429({"--svg", path})), ExitCode::done);
  EXPECT_EQ(out, "");
  std::ifstream in(path);
  const std::string svg{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  EXPECT_THAT(svg, HasSubstr("<title>tmc429 went from 0 to 20000 microsteps"));
  EXPECT_THAT(svg, HasSubstr("class=\"curve velocity\""));
  EXPECT_THAT(complaint(move_429({"--svg", "/nowhere/at/all"})), HasSubstr("/nowhere/at/all"));
}

/// Rows of numbers below a line of names.
std::vector<std::vector<double>> rows_of(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    auto& row = rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
  }
  return rows;
}

// Each jerk is drawn in a phase; what jumps between phases is in none.
TEST_F(CtlProfile, TheJerkAddsUpToTheAcceleration) {
  const std::vector<Words> s_curves{
      {"--generator", "tmc457", "v_max=5000000", "a_max=24624", "d_max=24624", "bow_max=7",
       "x_target=10000"},
      {"--generator", "tmc4361", "vmax=25600000", "amax=800000", "dmax=400000", "bow1=1000000",
       "bow2=2000000", "bow3=500000", "bow4=400000", "xtarget=300000"}};
  for (auto words : s_curves) {
    words.insert(words.end(), {"--show", "a,j", "--csv", "0.0001"});
    ASSERT_EQ(run(simulate(words)), ExitCode::done) << err;
    EXPECT_TRUE(out.starts_with("t,a,j\n"));
    double sum = 0;
    double greatest = 0;
    double farthest = 0;
    for (const auto& row : rows_of(out)) {
      farthest = std::max(farthest, std::abs(row.at(1) - sum));
      greatest = std::max(greatest, std::abs(row.at(1)));
      sum += row.at(2) * 0.0001;
    }
    EXPECT_GT(greatest, 1000) << words[1];
    EXPECT_LT(farthest, 0.05 * greatest) << words[1];
  }
}

// That of a TMC429 has: it slows down by a law of its own.
TEST_F(CtlProfile, ATrapezoidHasNoJerk) {
  const std::vector<Words> trapezoids{
      {"--generator", "tmc457", "v_max=5000000", "a_max=24624", "d_max=20000", "bow_max=0",
       "x_target=10000"},
      {"--generator", "sixpoint", "vmax=268000", "amax=3000", "dmax=2000", "xtarget=51200"},
      {"--generator", "mc1451a", "profile=trapezoidal", "velocity=65536", "acceleration=4000",
       "position=100"}};
  for (auto words : trapezoids) {
    const std::string step = words[1] == "mc1451a" ? "1" : "0.001";
    words.insert(words.end(), {"--show", "x,v,a,j", "--csv", step});
    ASSERT_EQ(run(simulate(words)), ExitCode::done) << err;
    EXPECT_TRUE(out.starts_with("t,x,v,a,j\n"));
    EXPECT_GT(rows_of(out).size(), 50U) << words[1];
    for (const auto& row : rows_of(out)) EXPECT_EQ(row.at(4), 0) << words[1] << ' ' << row[0];
  }
}

TEST_F(CtlProfile, DrawsWhatIsAskedForWithItsPhases) {
  EXPECT_EQ(run(move_429({"--show", "a,v"})), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("acceleration [internal]"));
  EXPECT_LT(out.find("acceleration ["), out.find("velocity ["));
  EXPECT_THAT(out, Not(HasSubstr("position [")));
  EXPECT_THAT(out, HasSubstr("|cruise"));
  for (const auto* bad : {"", "q", "x,", "x,,v", "v,v", "position", "X"})
    EXPECT_THAT(complaint(move_429({"--show", bad})), HasSubstr("--show")) << bad;
}

TEST_F(CtlProfile, AModelIsDrawnInTheUnitOfItsAxis) {
  EXPECT_EQ(run(simulate({"--model", "TMCM-142", "--screw-pitch", "5", "max_velocity=20mm/s",
                          "max_acceleration=200mm/s^2", "x_target=20mm", "--show", "x,v,a,j"})),
            ExitCode::done)
      << err;
  EXPECT_THAT(out, HasSubstr("tmc457 went from 0 to 20 mm in 1.11 s, fastest velocity 19.99"));
  for (const auto* unit : {"[mm]", "[mm/s]", "[mm/s^2]", "[mm/s^3]"})
    EXPECT_THAT(out, HasSubstr(unit));
}

// What a register counts in is what the positions say that it is.
TEST_F(CtlProfile, TheUnitsOfAModelAreThoseOfItsMovement) {
  for (const auto* model : {"TMCM-1110", "TMCM-142", "TMCM-6212", "TMCM-1378"}) {
    ASSERT_EQ(
        run(simulate({"--model", model, "max_velocity=20000pps", "max_acceleration=40000pps/s",
                      "target_position=30000", "--show", "v,a"})),
        ExitCode::done)
        << model << err;
    const auto speed = out.find("fastest velocity ");
    ASSERT_NE(speed, std::string::npos) << model;
    EXPECT_NEAR(std::stod(out.substr(speed + 17)), 20000, 400) << model;
    EXPECT_THAT(out, HasSubstr("acceleration [microsteps/s^2]"));
    EXPECT_THAT(out, testing::ContainsRegex("-[24]0000 |-50000 ")) << model;
  }
}

TEST_F(CtlProfile, ComparesProfilesInATableAndAPicture) {
  const Words move{"--generator", "tmc457",     "v_max=5000000", "a_max=24624",
                   "d_max=24624", "bow_max=11", "x_target=50000"};
  auto words = move;
  words.insert(words.end(), {"--with", "bow_max=0", "--with", "bow_max=14,v_max=4000000"});
  ASSERT_EQ(run(simulate(words)), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("PROFILE"));
  EXPECT_THAT(out, HasSubstr("as given"));
  EXPECT_THAT(out, HasSubstr("\nbow_max=0 "));
  EXPECT_THAT(out, HasSubstr("\nbow_max=14,v_max=4000000 "));

  auto json = simulate(words);
  json.insert(json.begin(), "--json");
  ASSERT_EQ(run(json), ExitCode::done);
  const auto together = boost::json::parse(out).as_object();
  auto alone = simulate(move);
  alone.insert(alone.begin(), "--json");
  std::ranges::replace(alone, std::string("bow_max=11"), std::string("bow_max=0"));
  ASSERT_EQ(run(alone), ExitCode::done);
  const auto alone_document = boost::json::parse(out).as_object();
  EXPECT_EQ(together.at("with").as_array().at(0).at("duration_s"), alone_document.at("duration_s"));
  EXPECT_EQ(together.at("with").as_array().at(0).at("settings"), "bow_max=0");
  EXPECT_NE(together.at("duration_s"), alone_document.at("duration_s"));

  EXPECT_THAT(complaint(move_429({"--with", "vmin=1"})), HasSubstr("no register 'vmin'"));
  EXPECT_THAT(complaint(move_429({"--with", "v_min=1", "--csv", "1"})),
              HasSubstr("exclude each other"));
  Words many;
  for (int i = 0; i < 21; ++i) many.insert(many.end(), {"--with", "v_min=2"});
  EXPECT_THAT(complaint(move_429(many)), HasSubstr("too many profiles"));
}

// Three pushes: up, down, and between them none. Without damping each adds a swing of its own.
TEST_F(CtlProfile, ALoadSwingsAsTheEquationSays) {
  for (const auto* hz : {"3", "7.5", "12"}) {
    auto words = simulate({"--generator", "sixpoint", "vmax=268435", "amax=3000", "dmax=3000",
                           "d1=3000", "xtarget=51200", "--resonance", hz, "--damping", "0"});
    words.insert(words.begin(), "--json");
    ASSERT_EQ(run(words), ExitCode::done) << out;
    const auto document = boost::json::parse(out).as_object();
    const auto number = [](const boost::json::value& value) { return value.to_number<double>(); };
    const double up = number(document.at("ramp_up").at("duration_s"));
    const double whole = number(document.at("duration_s"));
    const double w = 2 * std::numbers::pi * std::stod(hz);
    const double speed = number(document.at("peak_velocity")) * 16e6 / (1 << 24);
    const auto swung = [&](double time) { return std::polar(1.0, -w * time); };
    const auto sum = swung(0) - swung(up) - swung(whole - up) + swung(whole);
    const double expected = speed / up / (w * w) * std::abs(sum);
    EXPECT_NEAR(number(document.at("load").at("swing")), expected, 0.02 * speed / up / (w * w))
        << hz;
    const double swing = number(document.at("load").at("swing"));
    EXPECT_EQ(document.at("load").at("settled_s").is_null(), swing > 51.2) << swing;
  }
}

// As in figure 1 of the note: the motor has its velocity at once, and the load comes later.
TEST_F(CtlProfile, ALoadDoesNotTakeAVelocityAtOnce) {
  const auto document = [&] {
    auto words = simulate({"--generator", "tmc457", "mode=hold", "v_target=5000000", "--until",
                           "0.2", "--resonance", "10", "--damping", "0"});
    words.insert(words.begin(), "--json");
    EXPECT_EQ(run(words), ExitCode::done) << out;
    return boost::json::parse(out).as_object();
  }();
  const double speed = 5e6 * 16e6 / (1 << 30);
  const double expected = speed / (2 * std::numbers::pi * 10);
  EXPECT_NEAR(document.at("load").at("swing").to_number<double>(), expected, 0.01 * expected);
}

TEST_F(CtlProfile, TellsWithWhichProfileALoadSettlesFirst) {
  const Words words{"--model",       "TMCM-142",  "--screw-pitch", "5",      "max_velocity=20mm/s",
                    "x_target=10mm", "max_bow=0", "--resonance",   "12",     "--tolerance",
                    "0.001",         "--with",    "max_bow=6",     "--with", "max_bow=8"};
  ASSERT_EQ(run(simulate(words)), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("SWINGS [mm]"));
  EXPECT_THAT(out, HasSubstr("SETTLED [s]"));
  EXPECT_THAT(out, HasSubstr("the load settles first "));
  const std::filesystem::path path = tmcl::test::temp_path("ctl_load_test.svg");
  ASSERT_EQ(run(move_429({"--resonance", "5", "--svg", path})), ExitCode::done) << err;
  std::ifstream in(path);
  const std::string svg{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  EXPECT_THAT(svg, HasSubstr(">load</text>"));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray=\"2 5\""));
  EXPECT_THAT(complaint(move_429({"--tolerance", "1"})), HasSubstr("needs --resonance"));
  EXPECT_THAT(complaint(move_429({"--resonance", "0"})), HasSubstr("--resonance"));
  EXPECT_THAT(complaint(simulate({"--generator", "mc1451a", "position=10", "--resonance", "1"})),
              HasSubstr("counts in cycles"));
}

TEST_F(CtlProfile, OfASwingingMotorTheBeginningIsDrawn) {
  const Words words{"--generator", "tmc429",   "v_max=276", "a_max=1",        "pulse_div=1",
                    "ramp_div=5",  "pmul=223", "pdiv=0",    "x_target=13396", "last_step=r2"};
  ASSERT_EQ(run(simulate(words)), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("it swings on: only the first 40 phases, "));
}

TEST_F(CtlProfile, NamesWhatIsWrong) {
  const auto said = [this](const Words& words) { return complaint(simulate(words)); };
  EXPECT_THAT(said({}), HasSubstr("--generator"));
  EXPECT_THAT(said({"--generator", "tmc492"}), HasSubstr("Did you mean 'tmc429'?"));
  EXPECT_THAT(complaint(move_429({"vmin=1"})), HasSubstr("no register 'vmin'"));
  EXPECT_THAT(err, HasSubstr("Did you mean 'v_min'?"));
  EXPECT_THAT(complaint(move_429({"v_min"})), HasSubstr("'v_min' is no REGISTER=VALUE"));
  EXPECT_THAT(complaint(move_429({"=1"})), HasSubstr("'=1'"));
  EXPECT_THAT(complaint(move_429({"v_max=1"})), HasSubstr("v_max is given twice"));
  EXPECT_THAT(complaint(move_429({"mode=rmap"})), HasSubstr("Did you mean 'ramp'?"));
  EXPECT_THAT(complaint(move_429({"v_min=2048"})), HasSubstr("v_min is 0..2047, not 2048"));
  EXPECT_THAT(complaint(move_429({"--change", "1:v_min=-1"})),
              HasSubstr("--change 1:v_min=-1: v_min is 0..2047, not -1"));
  for (const auto* bad : {"", "-", "x", "1.5", "1e3", "0x", "0xg", "--1", "1 ",
                          "99999999999999999999", "-99999999999999999999"}) {
    const auto words = std::string("v_min=") + bad;
    EXPECT_THAT(complaint(move_429({words})), HasSubstr(words));
    EXPECT_THAT(complaint(move_429({"--change", "1:" + words})), HasSubstr(words));
  }
}

TEST_F(CtlProfile, NamesTheTimeThatIsWrong) {
  for (const auto* bad : {"", "x", "-1", "nan", "inf", "1e10", "1s"}) {
    for (const auto* option : {"--until", "--csv"}) {
      EXPECT_THAT(complaint(move_429({option, bad})), HasSubstr(bad));
    }
    EXPECT_THAT(complaint(move_429({"--change", std::string(bad) + ":v_max=1"})), HasSubstr(bad));
    auto words = move_429({"--json", "--sample", std::string("1,") + bad});
    EXPECT_EQ(run(words), ExitCode::usage) << bad;
    EXPECT_THAT(out, HasSubstr(bad));
  }
  EXPECT_THAT(complaint(move_429({"--csv", "0"})), HasSubstr("0 is not within"));
  EXPECT_THAT(complaint(move_429({"--csv", "1e-9"})), HasSubstr("1000000 at most"));
  EXPECT_THAT(complaint(move_429({"--change", "1"})), HasSubstr("'1' is no SECONDS:REGISTER"));
  EXPECT_THAT(complaint(move_429({"--change", "1:f_clk=8e6"})), HasSubstr("f_clk"));
  for (const auto* bad : {"0", "-1", "1e9", "nan", "x", ""}) {
    EXPECT_THAT(complaint(move_429({std::string("f_clk=") + bad})), HasSubstr("100000")) << bad;
  }
  EXPECT_THAT(complaint(move_429({"f_clk=1e6", "f_clk=1e6"})), HasSubstr("f_clk is given twice"));
}

TEST_F(CtlProfile, OneFormAtATime) {
  EXPECT_THAT(complaint(move_429({"--csv", "1", "--svg", "x"})), HasSubstr("exclude each other"));
  EXPECT_EQ(run(move_429({"--json", "--csv", "1"})), ExitCode::usage);
  EXPECT_THAT(complaint(move_429({"--sample", "1"})), HasSubstr("--json"));
}

TEST_F(CtlProfile, IsAGroupOfVerbs) {
  EXPECT_THAT(complaint({"profile"}), HasSubstr("a verb is missing: simulate"));
  EXPECT_THAT(complaint({"profile", "smulate"}), HasSubstr("no verb 'profile smulate'"));
  EXPECT_THAT(err, HasSubstr("Did you mean 'simulate'?"));
  EXPECT_THAT(complaint({"profile", "simulate", "--untli", "1"}), HasSubstr("'--until'"));
  EXPECT_THAT(information({"profile", "--help"}), HasSubstr("simulate"));
  EXPECT_THAT(information({"--help"}), HasSubstr("profile simulate --help"));
}

TEST_F(CtlProfile, TellsTheShellItsWords) {
  EXPECT_EQ(information({"__complete", "verbs", "profile"}), "simulate\nsolve\n");
  EXPECT_THAT(information({"__complete", "options", "profile", "simulate"}),
              HasSubstr("--change\n"));
  EXPECT_THAT(information({"__complete", "generators"}), HasSubstr("tmc429\n"));
  EXPECT_THAT(information({"__complete", "registers", "tmc429"}), HasSubstr("v_max=\n"));
  EXPECT_EQ(information({"__complete", "registers", "tmc429", "mode"}),
            "ramp\nsoft\nvelocity\nhold\n");
  EXPECT_EQ(information({"__complete", "registers", "tmc4"}), "");
  EXPECT_EQ(information({"__complete", "registers"}), "");
}

/// The command lines that a text shows, without "tmclctl".
std::vector<std::vector<std::string>> examples_in(std::string text) {
  for (auto at = text.find("\\\n"); at != std::string::npos; at = text.find("\\\n"))
    text.erase(at, 2);
  std::vector<std::vector<std::string>> examples;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<std::string> example;
    for (std::string word; words >> word;) example.push_back(word);
    if (example.empty() || example[0] != "tmclctl") continue;
    example.erase(example.begin());
    examples.push_back(std::move(example));
  }
  return examples;
}

TEST_F(CtlProfile, TheExamplesOfTheHelpWork) {
  const auto before = std::filesystem::current_path();
  const std::filesystem::path folder = tmcl::test::temp_path("ctl_profile_examples");
  std::filesystem::create_directories(folder);
  std::filesystem::current_path(folder);
  std::string seen;
  for (const auto& example : examples_in(information({"profile", "simulate", "--help"}))) {
    if (example[0] == "profile" && example[1] != "simulate") continue;
    EXPECT_EQ(run(example), ExitCode::done) << testing::PrintToString(example) << err;
    EXPECT_EQ(err, "") << testing::PrintToString(example);
    seen += testing::PrintToString(example);
  }
  std::filesystem::current_path(before);
  std::filesystem::remove_all(folder);
  for (const auto& generator : generators())
    EXPECT_THAT(seen, HasSubstr(std::string(generator.name)));
}

TEST(CtlGenerators, TheTablesNameRegistersAndValuesThatExist) {
  for (const auto& generator : generators()) {
    const auto find = [&](std::string_view name) {
      return tmcl::ramp::find_register(generator.registers, name);
    };
    for (const auto& info : generator.registers) {
      for (const auto name : info.names) {
        if (name.empty()) continue;
        const auto value = info.value_of(name);
        ASSERT_TRUE(value) << name;
        EXPECT_TRUE(info.takes(*value)) << name;
      }
    }
    for (const auto name : generator.written_last) EXPECT_TRUE(find(name)) << name;
    for (const auto& row : generator.defaults) {
      EXPECT_TRUE(find(row.register_name)) << row.register_name;
      EXPECT_TRUE(row.at_least.empty() || find(row.at_least)) << row.at_least;
    }
  }
}

// The three of the data sheet's page.
TEST(CtlGenerators, TakeTheUnitsOfADataSheet) {
  const auto registers = [](const std::vector<std::string>& settings) {
    verb::Simulate verb;
    verb.generator = "mc1451a";
    verb.settings = settings;
    std::map<std::string_view, std::int64_t> values;
    const auto setup = read_setup(verb);
    EXPECT_TRUE(setup) << setup.error().message;
    for (const auto& write : setup->script.start)
      values[setup->generator.registers[write.index].name] = write.value;
    return values;
  };
  const auto read = registers({"velocity=2.75", "acceleration=.175", "jerk=.0075"});
  EXPECT_EQ(read.at("velocity"), 0x2c000);
  EXPECT_EQ(read.at("acceleration"), 0x2ccd);
  EXPECT_EQ(read.at("jerk"), 0x1eb851f);
  EXPECT_EQ(registers({"velocity=180224"}).at("velocity"), 180'224);
  EXPECT_EQ(registers({"velocity=3.0"}).at("velocity"), 3 << 16);
  verb::Simulate verb;
  verb.generator = "mc1451a";
  for (const auto* wrong :
       {"acceleration=.51", "velocity=-0.5", "position=1.5", "velocity=2.75x"}) {
    verb.settings = {wrong};
    EXPECT_FALSE(read_setup(verb)) << wrong;
  }
  verb.settings = {"acceleration=.51"};
  EXPECT_THAT(read_setup(verb).error().message, HasSubstr("is 0..0.4999847412 steps/cycle^2"));
}

TEST(CtlGenerators, TheHelpNamesThemAll) {
  const auto help = information({"profile", "simulate", "--help"});
  for (const auto& generator : generators()) {
    EXPECT_THAT(help, HasSubstr(std::string(generator.name)));
    for (const auto& info : generator.registers)
      for (const auto name : info.names) EXPECT_THAT(help, HasSubstr(std::string(name)));
  }
}

TEST(CtlGenerators, TheManPageKnowsEveryOption) {
  std::ifstream in(TMCL_SOURCE_DIR "/docs/man/tmclctl.1");
  std::string page{std::istreambuf_iterator<char>(in), {}};
  std::erase(page, '\\');
  std::istringstream options(information({"__complete", "options", "profile", "simulate"}));
  for (std::string option; std::getline(options, option);)
    EXPECT_NE(page.find(option), std::string::npos) << option;
  for (const auto& generator : generators())
    EXPECT_NE(page.find(generator.name), std::string::npos) << generator.name;
}

}  // namespace
}  // namespace tmclctl::profile
