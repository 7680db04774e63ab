// What is said where a call cannot read what it needs to know: what came of that, and that it will
// never be known only where the module says so.
#include <gmock/gmock.h>

#include "unit/daemon_scale_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;

/// A lost answer is waited for three times.
std::string impatient_spindle() {
  auto config = spindle();
  constexpr std::string_view patience = "reply_timeout_ms = 500";
  return config.replace(config.find(patience), patience.size(), "reply_timeout_ms = 100");
}

// Axis x has a unit, which the microstep resolution of its module is needed for.
class DaemonReading : public DaemonScale {
 protected:
  DaemonReading() : DaemonScale(impatient_spindle()) {}

  using Condition = std::function<bool(const tmcl::Request&)>;

  static bool reads(const tmcl::Request& request, std::uint8_t parameter) {
    return request.command == Command::GAP && request.type == parameter;
  }
  void lose(Condition lost) {
    daemon.on_reactor([&] { return daemon.wire().loses = std::move(lost), 0; });
  }
  void lose_all_reads_of(std::uint8_t parameter) {
    lose([parameter](const tmcl::Request& request) { return reads(request, parameter); });
  }
  void refuse_reads_of(std::uint8_t parameter) {
    daemon.on_reactor([&] {
      daemon.wire().modules.at(1).refuse = [parameter](const tmcl::Request& request) {
        return reads(request, parameter) ? std::optional(tmcl::Status::wrong_type) : std::nullopt;
      };
      return 0;
    });
  }
  void expect_timeout(std::string_view method, const json::object& params) {
    const auto error = client->error(method, params);
    EXPECT_EQ(error.at("code"), -32000) << method << error;
    EXPECT_EQ(text(error.at("data").at("name")), "reply_timeout") << method;
    // The module is found again, and what was wrong is over.
    lose({});
    ASSERT_TRUE(daemon.eventually([&] {
      return daemon.daemon().gateway().axes()[0]->module().state() == GatewayModule::State::ready;
    }));
  }
};

constexpr std::uint8_t microstep_resolution = tmcl::axis_parameter::microstep_resolution;

TEST_F(DaemonReading, AResolutionWhoseAnswerIsLostIsATimeoutAndNoWrongArgument) {
  const std::vector<std::pair<std::string, json::object>> calls{
      {"axis.move_to", {{"axis", "x"}, {"position", 5}}},
      {"axis.rotate", {{"axis", "x"}, {"velocity", 5}}},
      {"parameter.set", {{"axis", "x"}, {"parameter", "max_velocity"}, {"value_in_unit", 5}}},
      {"axis.get_units", {{"axis", "x"}}},
      {"axis.get_state", {{"axis", "x"}}},
  };
  for (const auto& [method, params] : calls) {
    lose_all_reads_of(microstep_resolution);
    expect_timeout(method, params);
  }
  EXPECT_EQ(daemon.requests_seen(Command::MVP) + daemon.requests_seen(Command::ROR), 0U);
  EXPECT_TRUE(client->result("axis.move_to", {{"axis", "x"}, {"position", 5}})
                  .contains("target_microsteps"))
      << "the same call, a little later";
}

TEST_F(DaemonReading, AResolutionThatTheModuleRefusesToTellIsAWrongArgument) {
  refuse_reads_of(microstep_resolution);
  EXPECT_THAT(refusal("axis.move_to", {{"axis", "x"}, {"position", 5}}),
              HasSubstr("does not tell its microstep resolution"));
  EXPECT_TRUE(client->result("axis.get_state", {{"axis", "x"}}).at("position").is_null());
  EXPECT_TRUE(client->result("axis.get_units", {{"axis", "x"}}).at("unit").is_null());
}

TEST_F(DaemonReading, AResolutionThatABrokenRequestDidNotAskForIsNoWrongArgument) {
  daemon.on_reactor([&] {
    daemon.wire().modules.at(1).refuse = [](const tmcl::Request& request) {
      return reads(request, microstep_resolution) ? std::optional(tmcl::Status::wrong_checksum)
                                                  : std::nullopt;
    };
    return 0;
  });
  const auto error = client->error("axis.move_to", {{"axis", "x"}, {"position", 5}});
  EXPECT_EQ(error.at("code"), -32000) << error;
  EXPECT_EQ(text(error.at("data").at("status_name")), "wrong_checksum");
}

TEST_F(DaemonReading, UnitsOfTheModuleWhoseAnswersAreLostAreATimeout) {
  lose_all_reads_of(154);
  expect_timeout("axis.get_state", {{"axis", "plain"}});
  lose_all_reads_of(154);
  expect_timeout("axis.rotate", {{"axis", "x"}, {"velocity", 5}});
  refuse_reads_of(154);
  EXPECT_TRUE(client->result("axis.get_state", {{"axis", "plain"}}).at("velocity_pps").is_null());
}

TEST_F(DaemonReading, SettingsOfARampWhoseAnswersAreLostAreATimeoutOfTheLine) {
  const json::object line{{"axes", json::array{"x", "plain"}},
                          {"positions_microsteps", json::array{5, 5}}};
  lose_all_reads_of(tmcl::axis_parameter::max_acceleration);
  expect_timeout("line.move", line);
  refuse_reads_of(tmcl::axis_parameter::max_acceleration);
  EXPECT_THAT(refusal("line.move", line), HasSubstr("cannot be foreseen"));
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 0U);
}

TEST_F(DaemonReading, WhatIsDoneDoesNotFailBecauseItsUnitCannotBeRead) {
  lose_all_reads_of(microstep_resolution);
  const auto moved = client->result(
      "axis.move_to", {{"axis", "x"}, {"position_microsteps", 7}, {"predict", false}});
  EXPECT_EQ(moved.at("target_microsteps"), 7);
  EXPECT_TRUE(moved.at("target").is_null());
}

}  // namespace
}  // namespace tmcld::test
