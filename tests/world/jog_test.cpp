// A jogged axis comes to rest by itself without a further call, when the client, the gateway or
// the cable has gone.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/seconds.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;

/// On each kind of ramp generator: a model, and a speed and an acceleration in its own units.
struct Family {
  const char* model;
  std::int32_t most;
  std::int32_t velocity;
  std::vector<std::pair<std::uint8_t, std::int32_t>> ramp;  // the acceleration first
  std::int32_t bow = 0;                                     // of a TMC457
};
void PrintTo(const Family& family, std::ostream* out) { *out << family.model; }

const std::vector<Family> families{
    {"TMCM-3110", 1000, 500, {{5, 300}}},
    {"TMCM-142", 300'000, 100'000, {{16, 400'000}, {17, 400'000}}, 11},
    {"TMCM-6212", 200'000, 100'000, {{5, 400'000}, {17, 400'000}, {16, 0}}},
    {"TMCM-3351", 200'000, 100'000, {{5, 400'000}, {17, 400'000}}},
    {"TMCM-1021", 200'000, 100'000, {{5, 400'000}}},
};

class JogBench : public CableBench {
 public:
  explicit JogBench(const Family& family, const std::string& of_x = {})
      : CableBench(with(of_x), family.model), family_(family) {
    end_gateway();
    std::filesystem::create_directory(folder_);
    start_gateway(journal);
    for (const auto& [parameter, value] : family.ramp) must_set(parameter, value);
    must_set(ap::max_velocity, family.most);
    own_velocity = get(0, ap::max_velocity);
    const auto units = call("axis.get_units", {{"axis", "x"}});
    velocity_unit_ = units->at("velocity_unit_pps").to_number<double>();
    acceleration_unit_ = units->at("acceleration_unit_pps2").to_number<double>();
    acquire();
    events.clear();
  }
  ~JogBench() { std::filesystem::remove_all(folder_); }

  void acquire() {
    const auto lease = call("lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 60'000}});
    if (!lease) throw std::runtime_error(lease.error().message);
  }
  Result<json::object> jog(std::int32_t velocity, tmcl::Duration hold) {
    auto result = call("axis.jog",
                       {{"axis", "x"},
                        {"velocity_internal", velocity},
                        {"hold_ms", std::chrono::floor<std::chrono::milliseconds>(hold).count()}});
    if (result) target = static_cast<std::int32_t>(result->at("target_microsteps").as_int64());
    return result;
  }
  /// Is gone on with for some time; returns right behind the last call.
  void jog_for(tmcl::Duration duration, std::int32_t velocity, tmcl::Duration hold) {
    const auto end = time.now() + duration;
    while (true) {
      const auto gone_on = jog(velocity, hold);
      ASSERT_TRUE(gone_on) << gone_on.error().message;
      if (time.now() >= end) return;
      time.run_for(std::min<tmcl::Duration>(hold / 2, end - time.now()));
    }
  }
  std::int32_t position() { return get(0, ap::actual_position); }
  bool turns() { return get(0, ap::actual_velocity) != 0; }
  /// In microsteps per second, of the speed that it is jogged with.
  double speed() const { return family_.velocity * velocity_unit_; }
  /// From that to rest.
  tmcl::RampLength braking() {
    const double jerk = family_.bow > 0 ? tmcl::to_pps3(family_.bow).value
                                        : std::numeric_limits<double>::infinity();
    return tmcl::ramp_length({speed()}, {family_.ramp.front().second * acceleration_unit_}, {jerk});
  }

  const std::string folder_ =
      std::filesystem::temp_directory_path() / ("tmcl-jog-" + std::to_string(::getpid()));
  const std::string journal = folder_ + "/journal";
  std::int32_t target = 0;
  std::int32_t own_velocity = 0;

 private:
  static std::string with(const std::string& of_x) {
    std::string text = cable_config;
    const auto end_of_x = text.find("[[axis]]\nname = \"y\"");
    return text.insert(end_of_x, of_x);
  }
  void must_set(std::uint8_t parameter, std::int32_t value) {
    const auto set =
        call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
    if (!set) throw std::runtime_error(set.error().message);
  }
  const Family& family_;
  double velocity_unit_ = 0;
  double acceleration_unit_ = 0;
};

class Jog : public testing::TestWithParam<Family> {
 protected:
  std::int32_t velocity() const { return GetParam().velocity; }
  JogBench bench{GetParam()};
};

TEST_P(Jog, GoesOnWhileItIsCalledAgainAndSetsItsSpeedBack) {
  bench.jog_for(2s, velocity(), 200ms);
  EXPECT_TRUE(bench.turns());
  EXPECT_EQ(bench.get(0, ap::max_velocity), velocity());
  EXPECT_NEAR(bench.get(0, ap::actual_velocity), velocity(), velocity() * 0.01);
  bench.time_to_stand();
  bench.time.run_for(1s);
  EXPECT_EQ(bench.position(), bench.target);
  EXPECT_EQ(bench.get(0, ap::max_velocity), bench.own_velocity);
  EXPECT_THAT(bench.events, testing::Not(Contains("jog_broken")));
  EXPECT_EQ(bench.name_of_error(bench.call("axis.move_to", {{"axis", "x"}, {"position", 1}})),
            "none")
      << "it is free again";
}

TEST_P(Jog, TurnsRound) {
  bench.jog_for(1s, velocity(), 200ms);
  const auto there = bench.position();
  bench.jog_for(2s, -velocity(), 200ms);
  EXPECT_LT(bench.get(0, ap::actual_velocity), 0);
  EXPECT_LT(bench.position(), there);
  bench.time_to_stand();
  EXPECT_EQ(bench.position(), bench.target);
}

TEST_P(Jog, EndsAtOnceWithAVelocityOfNothing) {
  bench.jog_for(1s, velocity(), 1000ms);
  const auto ended = bench.jog(0, 1000ms);
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_FALSE(bench.turns());
  EXPECT_EQ(bench.position(), bench.target);
  bench.time.run_for(1s);
  EXPECT_EQ(bench.get(0, ap::max_velocity), bench.own_velocity);
  EXPECT_TRUE(bench.jog(velocity(), 100ms)) << "another one begins";
}

TEST_P(Jog, StandsWithinItsHoldAndTheRampWhateverIsGone) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<int> random(seed);
  double farthest = 0;
  const char* const names[] = {"client", "cut", "unplugged", "killed", "frozen"};
  for (int round = 0; round < tmcl::test::rounds(10) && !HasFailure(); ++round) {
    const auto what = round % 5;
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round) + ", " +
                 names[what]);
    JogBench one{GetParam()};
    const auto hold = std::chrono::milliseconds(random.between(100, 1000));
    one.jog_for(std::chrono::milliseconds(random.between(0, 3000)), velocity(), hold);
    const auto from = one.position();
    const auto called = one.time.now();
    one.time.run_for(std::chrono::microseconds(random.between(0, 90'000)));
    if (what == 0) one.client_leaves();
    if (what == 1) one.wire.is_cut = true;
    if (what == 2) one.wire.unplug();
    if (what == 3) one.end_gateway();
    if (what == 4) one.time.freeze_for(5s);
    tmcl::Duration seen_turning{};
    if (what == 4) {
      EXPECT_FALSE(one.turns()) << "its module alone stops it";
    } else {
      seen_turning = one.time_to_stand();
    }
    const auto overrun = std::abs(one.position() - from);
    const auto [ramp, way] = one.braking();
    farthest = std::max(farthest, overrun / (one.speed() * tmcl::seconds(hold) + way));
    EXPECT_LE(overrun, one.speed() * tmcl::seconds(hold) + way * 1.01 + 2) << hold.count() << " ms";
    // A gateway ends when the reply that it waits for is overdue: the axis may stand before that.
    if (seen_turning > tmcl::Duration{}) {
      EXPECT_LE(tmcl::seconds(one.time.now() - called), tmcl::seconds(hold) + 1.5 * ramp + 0.05);
    }
  }
  RecordProperty("farthest_of_allowed_percent", static_cast<int>(std::lround(100 * farthest)));
}

TEST_P(Jog, IsPutInOrderByTheNextDaemonIfThisOneIsKilled) {
  bench.jog_for(1s, velocity(), 500ms);
  std::ifstream file(bench.journal);
  const std::string left{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(left, HasSubstr("\"jog\""));
  bench.end_gateway();
  std::ofstream(bench.journal) << left;
  bench.time.run_for(5s);
  ASSERT_FALSE(bench.turns());
  ASSERT_EQ(bench.get(0, ap::max_velocity), velocity());
  bench.start_gateway(bench.journal);
  bench.time.run_for(5s);
  EXPECT_EQ(bench.get(0, ap::max_velocity), bench.own_velocity);
  EXPECT_THAT(bench.orphans, Contains(HasSubstr("(jog); ")));
}

TEST_P(Jog, EndsWithItsClientAndGivesTheSpeedBack) {
  bench.jog_for(1s, velocity(), 1000ms);
  bench.client_leaves();
  const auto took = bench.time_to_stand();
  EXPECT_LT(tmcl::seconds(took), 1.5 * bench.braking().seconds + 0.05) << "it is stopped at once";
  bench.time.run_for(1s);
  EXPECT_EQ(bench.get(0, ap::max_velocity), bench.own_velocity);
}

TEST_P(Jog, EndsWithAStop) {
  bench.jog_for(1s, velocity(), 1000ms);
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
  bench.time_to_stand();
  bench.time.run_for(1s);
  EXPECT_EQ(bench.get(0, ap::max_velocity), bench.own_velocity);
  EXPECT_THAT(bench.events, Contains("jog_broken"));
}

// What still comes of a press must not set off again what another client has stopped.
TEST_P(Jog, DoesNotGoOnBehindAStopOfAnotherClient) {
  bench.jog_for(1s, velocity(), 200ms);
  const auto jogs = bench.be_another_client();
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
  bench.be(jogs);
  for (int call = 0; call < 20; ++call) {
    EXPECT_EQ(bench.name_of_error(bench.jog(velocity(), 200ms)), "superseded_by_stop");
    bench.time.run_for(100ms);
  }
  bench.time_to_stand();
  const auto there = bench.position();
  bench.time.run_for(1s);
  EXPECT_EQ(bench.position(), there);
  EXPECT_TRUE(bench.jog(velocity(), 200ms)) << "another press";
  EXPECT_TRUE(bench.turns());
}

TEST_P(Jog, GoesOnBehindAStopOfItsOwnClient) {
  bench.jog_for(1s, velocity(), 200ms);
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
  EXPECT_TRUE(bench.jog(velocity(), 200ms));
}

TEST(JogLimits, ItNeverPassesASoftLimit) {
  JogBench bench(families[2], "soft_limits = [-3, 3]\n");
  for (const int direction : {1, -1}) {
    bench.jog_for(3s, direction * families[2].velocity, 300ms);
    bench.time_to_stand();
    EXPECT_EQ(bench.mm(0), direction * 3);
  }
}

TEST(JogLimits, BeyondThemItOnlyComesBack) {
  JogBench bench(families[2], "soft_limits = [-3, 3]\n");
  ASSERT_TRUE(bench.call("parameter.set", {{"axis", "x"}, {"parameter", 0}, {"value", 0}}));
  bench.other_master(
      {tmcl::ModuleAddress{1}, tmcl::Command::MVP, tmcl::move_type::absolute, 0, 51'200});
  bench.time.run_for(5s);
  ASSERT_EQ(bench.mm(0), 5);
  EXPECT_EQ(bench.name_of_error(bench.jog(100'000, 100ms)), "beyond_soft_limit");
  bench.time.run_for(1s);
  EXPECT_EQ(bench.mm(0), 5);
  EXPECT_EQ(bench.name_of_error(bench.jog(-100'000, 100ms)), "none");
}

TEST(JogRights, ItNeedsALeaseWhateverTheConfigurationSays) {
  JogBench bench(families[2]);
  bench.be_another_client();
  EXPECT_EQ(bench.name_of_error(bench.jog(1'000, 100ms)), "leased");
  CableBench free;
  const auto refused =
      free.call("axis.jog", {{"axis", "x"}, {"velocity_internal", 100}, {"hold_ms", 100}});
  EXPECT_EQ(free.name_of_error(refused), "not_permitted");
  EXPECT_FALSE(free.moves());
}

TEST(JogRights, ItIsNoFasterThanTheAxis) {
  JogBench bench(families[2]);
  EXPECT_EQ(bench.name_of_error(bench.jog(200'001, 100ms)), "bad_argument");
  EXPECT_FALSE(bench.turns());
  ASSERT_TRUE(bench.jog(1'000, 1000ms));
  EXPECT_EQ(bench.name_of_error(bench.jog(200'001, 100ms)), "bad_argument");
  EXPECT_TRUE(bench.turns()) << "the wish before still holds";
}

INSTANTIATE_TEST_SUITE_P(Families, Jog, testing::ValuesIn(families),
                         [](const auto& one) { return std::string(one.param.model).substr(5); });

}  // namespace
}  // namespace tmcld::test
