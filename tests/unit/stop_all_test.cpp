// A stop of everything: in which order, and at what cost.
#include <gmock/gmock.h>

#include <algorithm>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using tmcl::Command;

const std::string six_axes = [] {
  auto text = std::string(bench_bus);
  for (int module = 1; module <= 2; ++module) {
    for (int motor = 0; motor < 3; ++motor) {
      text += "[[axis]]\nname = \"m" + std::to_string(module) + std::to_string(motor) +
              "\"\nbus = \"bench\"\naddress = " + std::to_string(module) +
              "\nmotor = " + std::to_string(motor) + "\n";
    }
  }
  return text;
}();

TEST(StopOfAll, TakesOneExchangeAMotorThoseThatMoveFirstAndModulesInTurn) {
  VirtualGateway bench(six_axes);
  bench.wire.modules.emplace(std::uint8_t{2}, FakeModule(2));
  bench.time.run_for(3s);
  for (const char* axis : {"m22", "m12", "m21"})
    ASSERT_TRUE(bench.call("axis.rotate", {{"axis", axis}, {"velocity_internal", 100}}));
  bench.wire.seen.clear();
  ASSERT_TRUE(bench.call("system.stop_all", {}));
  std::vector<std::pair<int, int>> stops;
  for (const auto& request : bench.wire.seen) {
    if (request.command != Command::MST) break;
    stops.emplace_back(number(request.address), request.motor);
  }
  using Stop = std::pair<int, int>;
  EXPECT_THAT(stops,
              ElementsAre(Stop{1, 2}, Stop{2, 1}, Stop{2, 2}, Stop{1, 0}, Stop{2, 0}, Stop{1, 1}));
}

// ---- programs of modules ------------------------------------------------------------------------

struct ProgramOfAModule : testing::Test {
  ProgramOfAModule() {
    bench.time.run_for(3s);
    bench.wire.seen.clear();
    module.before = [](FakeModule& it, const tmcl::Request& request) {
      const bool ends = request.command == Command::STOP_APPLICATION;
      if (ends) it.application_status = 0;
    };
  }
  json::object stop_all() {
    auto answer = bench.call("system.stop_all", {});
    EXPECT_TRUE(answer) << answer.error().message;
    return answer ? *answer : json::object{};
  }
  /// The commands but for questions, each with its motor.
  static std::vector<std::pair<Command, int>> commands_of(
      const std::vector<tmcl::Request>& requests) {
    std::vector<std::pair<Command, int>> commands;
    for (const auto& request : requests)
      if (effect_of(request.command, request.type) != tmcl::Effect::reads)
        commands.emplace_back(request.command, request.motor);
    return commands;
  }
  std::vector<std::pair<Command, int>> sent() const { return commands_of(bench.wire.seen); }
  static std::size_t size_of(const json::object& answer, std::string_view list) {
    return answer.at(list).as_array().size();
  }

  VirtualGateway bench{std::string(bench_bus) + axis_section("x", 0)};
  FakeModule& module = bench.wire.modules.at(1);
  using Sent = std::pair<Command, int>;
  const std::vector<Sent> stops{{Command::MST, 0}, {Command::MST, 1}, {Command::MST, 2}};
  const std::vector<Sent> end{{Command::STOP_APPLICATION, 0},
                              {Command::RFS, 0},
                              {Command::RFS, 1},
                              {Command::RFS, 2},
                              {Command::MST, 0},
                              {Command::MST, 1},
                              {Command::MST, 2}};
  std::vector<Sent> stops_and_end() const {
    auto all = stops;
    all.insert(all.end(), end.begin(), end.end());
    return all;
  }
};

TEST_F(ProgramOfAModule, IsOnlyAskedWhetherItRuns) {
  EXPECT_EQ(size_of(stop_all(), "stopped"), 3U);
  EXPECT_EQ(sent(), stops);
  EXPECT_EQ(bench.wire.count(Command::GGP), 1U);
}

TEST_F(ProgramOfAModule, IsEndedAndTheMotorsAreStoppedOnceMore) {
  module.application_status = 1;
  EXPECT_EQ(size_of(stop_all(), "stopped"), 3U);
  EXPECT_EQ(sent(), stops_and_end());
}

TEST_F(ProgramOfAModule, ThatWasStartedHereIsEndedWithoutAQuestion) {
  ASSERT_TRUE(bench.call("program.run", {{"bus", "bench"}, {"address", 1}}));
  bench.wire.seen.clear();
  stop_all();
  EXPECT_EQ(sent(), stops_and_end());
  EXPECT_EQ(bench.wire.count(Command::GGP), 0U);
}

TEST_F(ProgramOfAModule, OfAFirmwareWithoutProgramsIsLeftAlone) {
  module.refuse = [](const tmcl::Request& request) {
    return request.command == Command::GGP ? std::optional(tmcl::Status::wrong_type) : std::nullopt;
  };
  EXPECT_EQ(size_of(stop_all(), "stopped"), 3U);
  EXPECT_EQ(sent(), stops);
}

TEST_F(ProgramOfAModule, ThatTheModuleDoesNotEndCountsAsMotorsThatAreNotStopped) {
  module.application_status = 1;
  module.refuse = [](const tmcl::Request& request) {
    const bool ends = request.command == Command::STOP_APPLICATION;
    return ends ? std::optional(tmcl::Status::invalid_command) : std::nullopt;
  };
  const auto answer = stop_all();
  EXPECT_EQ(size_of(answer, "stopped"), 0U);
  EXPECT_EQ(size_of(answer, "failed"), 3U);
}

/// From each command on, the module does not hear, or its answers are lost.
TEST_F(ProgramOfAModule, IsEndedLaterWhereTheModuleDoesNotAnswer) {
  for (const bool hears : {false, true}) {
    for (std::size_t heard = 0; heard < stops_and_end().size(); ++heard) {
      SCOPED_TRACE((hears ? "answers are lost after " : "silent after ") + std::to_string(heard));
      module.application_status = 1;
      bench.wire.seen.clear();
      const auto begin = std::ssize(module.executed());
      bench.wire.holds = !hears && heard == 0;
      bench.wire.loses = [&](const tmcl::Request&) {
        bench.wire.holds = !hears && sent().size() >= heard;
        return hears && sent().size() > heard;
      };
      EXPECT_GT(size_of(stop_all(), "failed"), 0U);
      bench.wire.loses = nullptr;
      bench.wire.holds = false;
      bench.wire.held.clear();
      bench.time.run_for(30s);
      EXPECT_EQ(module.application_status, 0);
      auto done = commands_of({module.executed().begin() + begin, module.executed().end()});
      std::ranges::reverse(done);
      const auto ended = std::ranges::find(done, Sent{Command::STOP_APPLICATION, 0});
      for (const auto& stop : stops) EXPECT_GE(std::count(done.begin(), ended, stop), 1);
    }
  }
}

}  // namespace
}  // namespace tmcld::test
