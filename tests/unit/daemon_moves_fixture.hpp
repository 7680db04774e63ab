/// Two axes x and y of a simulated TMCM-6212, and an example of every method that can move them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gateway/authority/motors.hpp"
#include "sim/module/module.hpp"
#include "support/no_events.hpp"
#include "tmcl/hex.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

/// What a FakeModule plays.
class SimulatedModule {
 public:
  explicit SimulatedModule(const tmcl::Clock& clock)
      : module_(*tmcl::find_model("TMCM-6212"), tmcl::ModuleAddress{1}, clock) {
    // It has a deadman, which stops nothing that these tests look at.
    constexpr std::int32_t deadman_ms = 3000;
    const tmcl::Request set{tmcl::ModuleAddress{1}, tmcl::Command::SGP,
                            tmcl::global_parameter::serial_heartbeat, tmcl::global_bank::parameters,
                            deadman_ms};
    module_.execute(set, tmcl::sim::Medium::serial, events_);
  }
  /// The module must not outlive this.
  void be_played_by(FakeModule& module) {
    module.play = [this](const tmcl::Request& request) {
      module_.run_due();
      const auto answer = module_.execute(request, tmcl::sim::Medium::serial, events_);
      return std::optional(
          tmcl::Reply{tmcl::default_host_address, 1, answer.status, request.command, answer.value});
    };
  }

 private:
  tmcl::test::NoEvents events_;
  tmcl::sim::Module module_;
};

/// With soft limits the module is asked more before a movement, and some movements are refused.
enum class Limits { none, wide };

inline std::string axes_x_and_y(Limits limits) {
  const std::string in_mm = std::string("unit = \"mm\"\nunits_per_revolution = 5\n") +
                            (limits == Limits::wide ? "soft_limits = [-1000, 1000]\n" : "");
  return "[[bus]]\nname = \"bench\"\nlink = \"serial:/dev/none@115200\"\nreply_timeout_ms = 60\n" +
         axis_section("x", 0, in_mm) + axis_section("y", 1, in_mm);
}

/// One call after the other, the last of them of the method. Each moves x, perhaps y as well.
struct MovingExample {
  struct Step {
    std::string method;
    json::object params;
  };
  std::vector<Step> steps;

  const std::string& method() const { return steps.back().method; }
};
inline void PrintTo(const MovingExample& example, std::ostream* out) {
  *out << example.method() << ' ' << json::serialize(example.steps.back().params);
}

/// Turns with this speed are those of the examples, and not of a path.
constexpr std::int32_t example_velocity = 4321;

inline json::object at_module(json::object more = {}) {
  more["bus"] = "bench";
  more["address"] = 1;
  return more;
}

inline std::vector<MovingExample> raw_examples() {
  const auto raw = [](std::string_view command, int type, int motor, int value) {
    return MovingExample{
        {{"module.execute",
          at_module({{"command", command}, {"type", type}, {"motor", motor}, {"value", value}})}}};
  };
  return {
      raw("ROR", 0, 0, example_velocity),
      raw("ROL", 0, 0, example_velocity),
      raw("MVP", 0, 0, 51'200),
      raw("MVP", 1, 0, 51'200),
      raw("MVP", 2, 0, 1),
      raw("MVP", 2, 0x83, 1),
      raw("SAP", 0, 0, 51'200),
      raw("SAP", 2, 0, example_velocity),
      raw("RFS", 0, 0, 0),
      raw("RUN_APPLICATION", 0, 0, 0),
      raw("SOFTWARE_RESET", 0, 0, 1234),
  };
}

inline std::vector<MovingExample> moving_examples() {
  const auto one = [](std::string method, json::object params) {
    return MovingExample{{{std::move(method), std::move(params)}}};
  };
  const MovingExample::Step path{
      "path.run", {{"axes", json::array{"x", "y"}}, {"text", "G1 X20 Y10 F1200\nG1 X40 Y0\n"}}};
  const auto image = tmcl::to_hex(std::vector<std::uint8_t>(16, 0x55));
  std::vector<MovingExample> examples{
      one("axis.move_to", {{"axis", "x"}, {"position_microsteps", 51'200}}),
      one("axis.move_to", {{"axis", "x"}, {"position", 5}, {"predict", false}}),
      one("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 51'200}}),
      one("axis.move_by", {{"axis", "x"}, {"distance", 5}, {"predict", false}}),
      one("axis.rotate", {{"axis", "x"}, {"velocity_internal", example_velocity}}),
      one("axis.resonance", {{"axis", "x"}, {"distance_microsteps", 51'200}, {"listen_ms", 50}}),
      {{{"lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 60'000}}},
        {"axis.jog",
         {{"axis", "x"}, {"velocity_internal", example_velocity}, {"hold_ms", 1'000}}}}},
      one("line.move",
          {{"axes", json::array{"x", "y"}}, {"positions_microsteps", json::array{51'200, 25'600}}}),
      one("line.move", {{"axes", json::array{"x"}}, {"positions", json::array{5}}}),
      {{path}},
      {{path,
        {"path.pause", {{"axes", json::array{"x"}}}},
        {"path.resume", {{"axes", json::array{"x"}}}}}},
      {{path,
        {"path.feed", {{"axes", json::array{"x"}}, {"hold", true}}},
        {"path.feed", {{"axes", json::array{"x"}}, {"hold", false}}}}},
      one("mint.run", {{"axes", json::array{"x"}},
                       {"text", "SPEED = 9000\nACCEL = 90000\nMOVEA = 51200\nGO\n"}}),
      one("axis.home", {{"axis", "x"}, {"mode", 1}}),
      one("axis.start_home", {{"axis", "x"}, {"mode", 1}}),
      one("axis.start_home", {{"axis", "x"}}),
      one("axis.test_deadman", {{"axis", "x"}}),
      one("axis.verify", {{"axis", "x"}, {"from_microsteps", 0}, {"to_microsteps", 2'000}}),
      one("axis.tune", {{"axis", "x"},
                        {"max_current", 100},
                        {"from_microsteps", 0},
                        {"to_microsteps", 200'000}}),
      one("parameter.set", {{"axis", "x"}, {"parameter", 0}, {"value", 51'200}}),
      one("parameter.set", {{"axis", "x"}, {"parameter", 2}, {"value", example_velocity}}),
      one("parameter.restore", {{"axis", "x"}, {"parameter", 5}}),
      one("coordinate.move", {{"axis", "x"}, {"number", 1}}),
      one("coordinate.start", at_module({{"number", 1}, {"motors", json::array{0}}})),
      one("coordinate.start", at_module({{"number", 1}, {"motors", json::array{0, 1}}})),
      one("module.reset", at_module()),
      one("module.factory_reset", at_module()),
      one("program.run", at_module()),
      one("program.step", at_module()),
      one("program.step_to", at_module()),
      {{{"firmware.stage", {{"offset", 0}, {"data", image}}},
        {"firmware.upload", at_module({{"start", 0}, {"bytes", 16}, {"force", true}})}}},
  };
  const auto raw = raw_examples();
  examples.insert(examples.begin(), raw.begin(), raw.end());
  return examples;
}

/// Whether the request can move x, and none of the daemon's own movements along a path does it.
inline bool is_example(const tmcl::Request& request) {
  const bool turns = request.command == tmcl::Command::ROR || request.command == tmcl::Command::ROL;
  return can_move(request) && (!turns || request.value == example_velocity);
}

class MovesBench {
 public:
  explicit MovesBench(bool until_ready = true, Limits limits = Limits::none,
                      const std::string& on_exit = "stop")
      : daemon("on_exit = \"" + on_exit + "\"\n" + axes_x_and_y(limits), reactor_) {
    module_.be_played_by(daemon.wire().modules.at(1));
    daemon.start(until_ready);
    client = std::make_unique<RpcClient>(daemon.socket());
  }

 private:
  std::shared_ptr<VirtualReactor> reactor_ = std::make_shared<VirtualReactor>();
  SimulatedModule module_{reactor_->clock};

 public:
  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

}  // namespace tmcld::test
