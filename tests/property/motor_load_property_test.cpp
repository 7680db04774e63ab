// Motors with any limits, loads and faults: it does not matter when somebody looks; and motors that
// can do all that is asked of them are as if they had no limits.
#include <gtest/gtest.h>

#include <string>

#include "support/lone_module.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmcl::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

struct World : test::LoneModule {
  using LoneModule::LoneModule;

  std::string state() const {
    std::string text;
    for (const auto number : {1, 3, 180, 206, 207, 208, 209}) {
      const auto value = module.axis(0).get(static_cast<std::uint8_t>(number));
      text += std::to_string(number) + '=' + (value ? std::to_string(*value) : "none") + ' ';
    }
    return text + "stage=" + std::to_string(module.stage(0).position());
  }
};

/// What somebody does to the world outside the module.
struct Event {
  enum class Kind : std::uint8_t { none, load, fault, supply, brown_out } kind = Kind::none;
  std::int32_t value = 0;
  DriverFault fault = DriverFault::short_a;

  void happen(Module& module) const {
    switch (kind) {
      case Kind::none: return;
      case Kind::load: module.at_stage(0, [this](Stage& stage) { stage.set_load(value); }); return;
      case Kind::fault:
        module.at_stage(0, [this](Stage& stage) { stage.set_fault(fault, value != 0); });
        return;
      case Kind::supply: module.set_supply(value); return;
      case Kind::brown_out: module.brown_out(milliseconds(1 + value)); return;
    }
  }
};

class Script : public test::Random<std::int32_t> {
 public:
  using Random::Random;

  StageSettings stage() {
    StageSettings stage{.encoder = EncoderSettings{51'200, one_in(4)}};
    if (one_in(4)) stage.right_stop = 1000 + any_size(60'000);
    if (one_in(2)) stage.load = any_size(1100);
    if (one_in(2)) stage.load_per_velocity = any_size(4000);
    if (one_in(4)) stage.pull = one_in(2) ? any_size(800) : -any_size(800);
    if (one_in(2)) stage.inertia = any_size(1'000'000);
    if (one_in(2)) stage.corner_speed = 1 + any_size(2000);
    if (one_in(2)) stage.pull_in_speed = any_size(500);
    stage.torque_follows_current = one_in(2);
    if (one_in(2)) stage.load_value_slope = any_size(4000);
    if (one_in(4)) stage.load_value_noise = any_size(100);
    if (one_in(4)) stage.backlash = any_size(2000);
    if (one_in(4)) stage.resonance = ramp::Resonance{static_cast<double>(positive(60)), 0.05};
    return stage;
  }

  StageSettings generous_stage() {
    auto limits = stage();
    limits.load = any_size(400);
    limits.load_per_velocity = 0;
    limits.pull = 0;
    limits.inertia = 0;
    limits.corner_speed = 1'000'000'000;
    limits.torque_follows_current = false;
    // How it swings is worked out in pieces, and they are shorter where there are limits.
    limits.resonance.reset();
    return limits;
  }

  Request command(bool sixpoint) {
    const auto with = [](Command command, std::uint8_t type, std::int32_t value) {
      return Request{ModuleAddress{1}, command, type, 0, value};
    };
    const auto fastest = sixpoint ? 500'000 : 2047;
    switch (between(0, 13)) {
      case 0: return with(Command::ROR, 0, any_size(fastest));
      case 1: return with(Command::ROL, 0, any_size(fastest));
      case 2: return with(Command::MST, 0, 0);
      case 3: return with(Command::SAP, 5, 1 + any_size(sixpoint ? 5'000'000 : 2046));
      case 4: return with(Command::SAP, 6, any_size(255));
      case 5: return with(Command::SAP, 181, one_in(2) ? 0 : any_size(fastest));
      case 6: return with(Command::SAP, 182, one_in(2) ? 0 : any_size(fastest));
      case 7: return with(Command::SAP, 167, one_in(4) ? 0 : 4);
      case 8:
        return with(Command::SAP, static_cast<std::uint8_t>(168 + between(0, 4)), between(0, 1));
      case 9:
      case 10: return with(Command::SAP, 172, 1 + any_size(14));
      case 11: return with(Command::SAP, 1, either_way(any_size(8'000'000)));
      default: return with(Command::MVP, 0, either_way(any_size(200'000)));
    }
  }

  Event event() {
    using Kind = Event::Kind;
    switch (between(0, 9)) {
      case 0: return {Kind::load, any_size(1100)};
      case 1: return {Kind::fault, between(0, 2), static_cast<DriverFault>(2 << between(0, 5))};
      case 2: return {Kind::supply, between(40, 480)};
      case 3: return {Kind::brown_out, any_size(1000)};
      default: return {};
    }
  }
};

struct Pair {
  World seldom;
  World often;
  Pair(std::uint16_t model, const StageSettings& one, const StageSettings& other)
      : seldom(model, one), often(model, other) {}

  void step(Script& script, bool sixpoint, bool with_events) {
    const auto request = script.command(sixpoint);
    EXPECT_EQ(seldom.ask(request), often.ask(request));
    const auto event = with_events ? script.event() : Event{};
    event.happen(seldom.module);
    event.happen(often.module);
    const auto until = seldom.clock.now() + milliseconds(script.any_size(3000));
    while (often.clock.now() < until) {
      const auto next = often.clock.now() + microseconds(1 + script.any_size(200'000));
      often.look_at(std::min(next, until));
      (void)often.state();
    }
    seldom.look_at(until);
    EXPECT_EQ(seldom.state(), often.state());
  }
};

constexpr int scripts = 400;
constexpr int steps = 8;

bool has_lost_steps(const World& world) {
  const auto read = [&](std::uint8_t number) { return world.module.axis(0).get(number); };
  return read(1).value_or(0) != read(209).value_or(0);
}

TEST(MotorLoadProperty, LookingChangesNothing) {
  int lost = 0;
  int cooled = 0;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + scripts; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    const bool sixpoint = script.one_in(2);
    const auto stage = script.stage();
    Pair pair(sixpoint ? 1276 : 3110, stage, stage);
    for (int step = 0; step < steps; ++step) {
      pair.step(script, sixpoint, true);
      ASSERT_FALSE(testing::Test::HasFailure()) << "step " << step;
      const auto& axis = pair.seldom.module.axis(0);
      cooled += axis.get(172).value_or(0) != 0 && axis.get(3).value_or(0) != 0 ? 1 : 0;
    }
    lost += has_lost_steps(pair.seldom) ? 1 : 0;
  }
  EXPECT_GT(lost, scripts / 10);
  EXPECT_GT(cooled, scripts / 10);
}

TEST(MotorLoadProperty, LimitsThatAreNotReachedChangeNothing) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + scripts; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    const bool sixpoint = script.one_in(2);
    const auto generous = script.generous_stage();
    auto plain = generous;
    plain.corner_speed.reset();
    Pair pair(sixpoint ? 1276 : 3110, generous, plain);
    for (int step = 0; step < steps; ++step) {
      pair.step(script, sixpoint, false);
      ASSERT_FALSE(testing::Test::HasFailure()) << "step " << step;
    }
  }
}

}  // namespace
}  // namespace tmcl::sim
