/// A daemon with two axes of a simulated TMCM-6212 in the test's own process, for paths.
#pragma once

#include <gmock/gmock.h>

#include "sim/module/module.hpp"
#include "support/no_events.hpp"
#include "tmcl/parameter.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

using tmcl::Command;
namespace ap = tmcl::axis_parameter;

constexpr std::int32_t own_velocity = 240'000;
constexpr std::int32_t own_acceleration = 4'999'922;
constexpr double microsteps_per_mm = 51'200 / 5.0;

/// What a FakeModule plays: everything but what the test refuses.
class Played {
 public:
  explicit Played(const tmcl::Clock& clock)
      : module_(*tmcl::find_model("TMCM-6212"), tmcl::ModuleAddress{1}, clock) {
    for (std::uint8_t motor = 0; motor < 2; ++motor) {
      set(motor, ap::max_velocity, own_velocity);
      set(motor, ap::max_acceleration, own_acceleration);
      set(motor, 17, own_acceleration);
    }
  }
  /// The module must not outlive this.
  void be_played_by(FakeModule& module) {
    module.play = [this](const tmcl::Request& request) -> std::optional<tmcl::Reply> {
      if (before) before(request);
      if (refuse && refuse(request)) {
        return tmcl::Reply{tmcl::default_host_address, 1, tmcl::Status::invalid_value,
                           request.command, request.value};
      }
      return execute(request);
    };
  }

  /// Called on the daemon's thread, as what follows.
  std::function<void(const tmcl::Request&)> before;
  std::function<bool(const tmcl::Request&)> refuse;

  tmcl::Reply execute(const tmcl::Request& request) {
    module_.run_due();
    const auto answer = module_.execute(request, tmcl::sim::Medium::serial, events_);
    return {tmcl::default_host_address, 1, answer.status, request.command, answer.value};
  }
  std::int32_t get(std::uint8_t motor, std::uint8_t parameter) {
    return execute({tmcl::ModuleAddress{1}, Command::GAP, parameter, motor, 0}).value;
  }
  void set(std::uint8_t motor, std::uint8_t parameter, std::int32_t value) {
    execute({tmcl::ModuleAddress{1}, Command::SAP, parameter, motor, value});
  }
  double mm(std::uint8_t motor) { return get(motor, ap::actual_position) / microsteps_per_mm; }
  bool moves() { return get(0, ap::actual_velocity) != 0 || get(1, ap::actual_velocity) != 0; }

 private:
  tmcl::test::NoEvents events_;
  tmcl::sim::Module module_;
};

constexpr std::string_view in_mm = "unit = \"mm\"\nunits_per_revolution = 5\n";

inline std::string path_bench(const std::string& of_y) {
  return "[[bus]]\nname = \"bench\"\nlink = \"serial:/dev/none@115200\"\nreply_timeout_ms = 60\n" +
         axis_section("x", 0, std::string(in_mm)) + axis_section("y", 1, of_y);
}

class DaemonPath : public testing::Test {
 protected:
  explicit DaemonPath(const std::string& of_y = std::string(in_mm))
      : daemon(path_bench(of_y), reactor) {
    module.be_played_by(daemon.wire().modules.at(1));
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
  }

  json::object order(const std::string& text, json::object more = {}) {
    json::object params{{"axes", json::array{"x", "y"}}, {"text", text}, {"deviation", 4}};
    for (const auto& [name, value] : more) params[name] = value;
    return params;
  }
  json::object error_of(int id) {
    const auto answer = client->answer_to(id);
    if (!answer.contains("error")) throw std::runtime_error(json::serialize(answer));
    return answer.at("error").as_object();
  }
  std::string name_in(const json::object& error) { return text(error.at("data").at("name")); }
  template <class Function>
  auto on_module(Function function) {
    return daemon.on_reactor([&] { return function(module); });
  }
  double mm(std::uint8_t motor) {
    return on_module([&](Played& played) { return played.mm(motor); });
  }
  bool until_x_is_beyond(double position) {
    return daemon.eventually([&] { return module.mm(0) > position; });
  }
  void expect_rest_and_own_settings() {
    for (std::uint8_t motor = 0; motor < 2; ++motor) {
      const auto read = [&](std::uint8_t parameter) {
        return on_module([&](Played& played) { return played.get(motor, parameter); });
      };
      EXPECT_EQ(read(ap::actual_velocity), 0);
      EXPECT_EQ(read(ap::max_velocity), own_velocity);
      EXPECT_EQ(read(ap::max_acceleration), own_acceleration);
      EXPECT_EQ(read(17), own_acceleration);
      EXPECT_EQ(read(16), 25'600);
      EXPECT_EQ(read(20), 10);
    }
  }

  std::shared_ptr<VirtualReactor> reactor = std::make_shared<VirtualReactor>();
  Played module{reactor->clock};
  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

// 20 mm/s: half a second, and two.
inline const std::string short_way = "G1 X8 Y4 F1200\nG1 X9 Y2\n";
inline const std::string long_way = "G1 X20 Y10 F1200\nG1 X40 Y0\n";

}  // namespace tmcld::test
