/// Axes in units of their own, on modules that hold what a test says.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

inline std::string spindle() {
  return std::string(bench_bus) +
         axis_section("x", 0, "unit = \"mm\"\nunits_per_revolution = 5.0\n") +
         axis_section("back", 1, R"(
unit = "deg"
units_per_revolution = 360
reverse = true
full_steps = 400
microsteps = 16
)") + axis_section("plain", 2);
}

class DaemonScale : public testing::Test {
 protected:
  explicit DaemonScale(const std::string& axes = spindle()) : daemon(axes) {
    daemon.wire().model = 3110;
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
    hold(0, 140, 8);
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}}) {
      hold(motor, 153, 3);
      hold(motor, 154, 2);
    }
  }
  void hold(std::uint8_t motor, std::uint8_t parameter, std::int32_t value) {
    daemon.on_reactor(
        [&] { return daemon.wire().modules.at(1).parameter(motor, parameter) = value; });
  }
  tmcl::Request last(tmcl::Command command) {
    return daemon.on_reactor([&] {
      const auto& seen = daemon.wire().seen;
      const auto found = std::ranges::find(seen.rbegin(), seen.rend(), command,
                                           [](const auto& request) { return request.command; });
      return found == seen.rend() ? tmcl::Request{} : *found;
    });
  }
  std::string refusal(std::string_view method, json::object params) {
    const auto error = client->error(method, std::move(params));
    EXPECT_EQ(error.at("code"), -32602);
    return text(error.at("message"));
  }

  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

inline std::string mechanics() {
  return std::string(bench_bus) + axis_section("screw", 0, R"(
unit = "mm"
screw_pitch = 7.3
gear_ratio = 3.71
microsteps = 16
soft_limits = [-2.5, 120]
encoder_lines = 1000
)") + axis_section("table", 1, R"(
unit = "deg"
units_per_revolution = 360
reverse = true
microsteps = 16
soft_limits = [-90, 180]
)") + axis_section("free", 2, "unit = \"mm\"\nscrew_pitch = 7.3\ngear_ratio = 3.71\n");
}

class DaemonMechanics : public DaemonScale {
 protected:
  explicit DaemonMechanics(const std::string& axes = mechanics()) : DaemonScale(axes) {
    hold(2, 140, 4);
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}})
      hold(motor, 1, 0);
  }
  std::int64_t target_of(std::string_view method, json::object params) {
    return client->result(method, std::move(params)).at("target_microsteps").as_int64();
  }
  json::object beyond(std::string_view method, json::object params) {
    auto error = client->error(method, std::move(params));
    EXPECT_EQ(error.at("code"), -32602);
    EXPECT_EQ(error.at("data").at("name"), "beyond_soft_limit") << error;
    EXPECT_EQ(error.at("data").at("outcome"), "not_sent");
    return error;
  }
  void expect_nothing_sent() {
    for (const auto command :
         {tmcl::Command::MVP, tmcl::Command::ROR, tmcl::Command::ROL, tmcl::Command::SAP})
      EXPECT_EQ(daemon.requests_seen(command), 0U) << name_of(command);
  }
};

}  // namespace tmcld::test
