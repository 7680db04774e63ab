// Whatever a motor drives, it does not matter how often somebody looks.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "support/lone_module.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmcl::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

using World = test::LoneModule;

class Script : public test::Random<std::int32_t> {
 public:
  using Random::Random;

  StageSettings stage() {
    StageSettings stage;
    if (one_in(2)) stage.left_switch = -place();
    if (one_in(2)) stage.right_switch = place();
    if (one_in(2)) stage.home = Interval{-100, 300};
    if (one_in(3)) stage.left_stop = -place();
    if (one_in(3)) stage.right_stop = place();
    if (one_in(2)) stage.encoder = EncoderSettings{positive(60'000), one_in(8)};
    stage.switch_tolerance = any_size(100);
    stage.load = one_in(3) ? any_size(900) : 0;
    return stage;
  }

  Request command() {
    const auto with = [](Command command, std::uint8_t type, std::int32_t value) {
      return Request{ModuleAddress{1}, command, type, 0, value};
    };
    switch (between(0, 9)) {
      case 0: return with(Command::ROR, 0, any_size(2047));
      case 1: return with(Command::ROL, 0, any_size(2047));
      case 2: return with(Command::MST, 0, 0);
      case 3: return with(Command::RFS, 0, 0);
      case 4: return with(Command::SAP, 193, either_way(64) + between(65, 72));
      case 5: return with(Command::SAP, 212, one_in(2) ? 0 : any_size(5000));
      case 6: return with(Command::SAP, 181, one_in(2) ? 0 : any_size(1000));
      case 7: return with(Command::SAP, 1, either_way(any_size(8'000'000)));
      default: return with(Command::MVP, 0, either_way(any_size(100'000)));
    }
  }

 private:
  std::int32_t place() { return 1000 + any_size(60'000); }
};

void expect_same(const World& one, const World& other) {
  for (const auto number : std::to_array<std::uint8_t>({1, 3, 8, 9, 10, 11, 196, 197, 207, 209})) {
    EXPECT_EQ(one.module.axis(0).get(number), other.module.axis(0).get(number)) << int{number};
  }
  EXPECT_EQ(one.module.stage(0).position(), other.module.stage(0).position());
  EXPECT_EQ(one.module.axis(0).search_step(), other.module.axis(0).search_step());
}

// How many scripts have shown what.
struct Coverage {
  int switches = 0;
  int errors = 0;
  int references = 0;

  void add(const Module& module) {
    const auto& axis = module.axis(0);
    switches += axis.switches() == Switches{} ? 0 : 1;
    errors += axis.stalled() || axis.deviated() ? 1 : 0;
    references += axis.get(197).value_or(0) != 0 ? 1 : 0;
  }
};

TEST(SimLooking, ChangesNothing) {
  Coverage coverage;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 300; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    const auto model = script.one_in(2) ? std::uint16_t{3110} : std::uint16_t{6212};
    const auto stage = script.stage();
    World seldom(model, stage);
    World often(model, stage);
    for (int step = 0; step < 6; ++step) {
      const auto request = script.command();
      EXPECT_EQ(seldom.ask(request.command, request.type, request.value),
                often.ask(request.command, request.type, request.value));
      const auto until = seldom.clock.now() + milliseconds(script.any_size(5000));
      while (often.clock.now() < until) {
        const auto next = often.clock.now() + microseconds(1 + script.any_size(200'000));
        often.look_at(std::min(next, until));
      }
      seldom.look_at(until);
      expect_same(seldom, often);
      ASSERT_FALSE(testing::Test::HasFailure()) << "step " << step;
    }
    coverage.add(seldom.module);
  }
  EXPECT_GT(coverage.switches, 30);
  EXPECT_GT(coverage.errors, 30);
  EXPECT_GT(coverage.references, 5);
}

}  // namespace
}  // namespace tmcl::sim
