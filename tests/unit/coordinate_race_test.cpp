// A coordinate that another client changes while it is checked takes no axis beyond its soft
// limits: where a module goes is what was checked, at whichever step the other client comes.
#include <array>

#include <gmock/gmock.h>

#include "tmcl/command_type.hpp"
#include "unit/port_fixture.hpp"

namespace tmcld::test {
namespace {

constexpr std::int32_t limit = 1000;
constexpr std::int32_t within = 500;
constexpr std::int32_t beyond = 30'000;
constexpr std::uint8_t coordinate = 1;
constexpr std::uint8_t both_motors = 0x83;
constexpr std::array<std::uint8_t, 2> both{0, 1};

std::string limited_axes() {
  const auto limits =
      "soft_limits = [-" + std::to_string(limit) + ", " + std::to_string(limit) + "]\n";
  return std::string(bench_bus) + axis_section("x", 0, limits) + axis_section("y", 1, limits);
}

class CoordinateRace : public testing::TestWithParam<int> {
 protected:
  CoordinateRace() {
    for (const auto motor : both)
      module().execute_quietly(request_of(Command::SCO, coordinate, motor, within));
    module().before = [this](FakeModule&, const Request&) {
      if (++step_ == changes_at_) change();
    };
  }
  FakeModule& module() { return bench_.wire.modules.at(1); }
  /// From the n-th command of what is tried on, another client changes the coordinate.
  void change_at_step(int n) {
    step_ = 0;
    changes_at_ = n;
  }
  void change() {
    bench_.begin_call("coordinate.set",
                      {{"axis", "x"}, {"number", coordinate}, {"position_microsteps", beyond}},
                      changes_);
  }
  /// Where the module has sent x, as its coordinates were at that moment.
  std::vector<std::int32_t> targets() {
    std::vector<std::int32_t> all;
    auto held = within;
    for (const auto& request : module().executed()) {
      if (request.command == Command::SCO && request.motor == 0) held = request.value;
      if (request.command != Command::MVP) continue;
      all.push_back(request.type == tmcl::move_type::coordinate ? held : request.value);
    }
    return all;
  }
  void expect_within() {
    bench_.time.run_for(std::chrono::seconds(1));
    for (const auto target : targets()) EXPECT_LE(target, limit);
  }

  VirtualGateway bench_{limited_axes()};
  std::vector<Result<boost::json::object>> changes_;
  int step_ = 0;
  int changes_at_ = 0;
};

TEST_P(CoordinateRace, OneAxisGoesWhereItWasChecked) {
  change_at_step(GetParam());
  bench_.call("coordinate.move", {{"axis", "x"}, {"number", coordinate}});
  expect_within();
}

TEST_P(CoordinateRace, AxesThatStartTogetherGoWhereTheyWereChecked) {
  change_at_step(GetParam());
  bench_.call(
      "coordinate.start",
      {{"bus", "bench"}, {"address", 1}, {"number", coordinate}, {"motors", json::array{0, 1}}});
  expect_within();
}

TEST_P(CoordinateRace, AHostAtAPortIsHeldToIt) {
  for (const std::uint8_t motor : {std::uint8_t{0}, both_motors}) {
    PortHost host(bench_, "a", Role::operate);
    change_at_step(GetParam());
    host.ask(request_of(Command::MVP, tmcl::move_type::coordinate, motor, coordinate));
    expect_within();
    change_at_step(0);
    module().execute(request_of(Command::SCO, coordinate, 0, within));
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, CoordinateRace, testing::Range(1, 24));

TEST(CoordinateMove, IsAnsweredLikeTheCommandThatWasSent) {
  VirtualGateway bench(limited_axes());
  auto& module = bench.wire.modules.at(1);
  module.execute_quietly(request_of(Command::SCO, coordinate, 0, within));
  PortHost host(bench, "a", Role::operate);
  const auto reply = host.ask(request_of(Command::MVP, tmcl::move_type::coordinate, 0, coordinate));
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->value, coordinate);
  EXPECT_EQ(module.executed().back(), request_of(Command::MVP, 0, 0, within));
}

TEST(CoordinateStart, IsRefusedWhileAProgramRunsThatMayChangeCoordinates) {
  VirtualGateway bench(limited_axes());
  auto& module = bench.wire.modules.at(1);
  for (const auto motor : both)
    module.execute_quietly(request_of(Command::SCO, coordinate, motor, within));
  module.application_status = 1;
  const auto answer = bench.call(
      "coordinate.start",
      {{"bus", "bench"}, {"address", 1}, {"number", coordinate}, {"motors", json::array{0, 1}}});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().name, "not_permitted");
}

}  // namespace
}  // namespace tmcld::test
