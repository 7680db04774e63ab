// Which exit code and which words an error becomes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>

#include "failure.hpp"
#include "names.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;

tmcl::Error bus_error(tmcl::Errc code, tmcl::Outcome outcome) {
  return {code, outcome, "it failed", "try again", "bench", {}, {}};
}

tmcl::client::CallError call_error(int code, std::string name, tmcl::Outcome outcome) {
  return {code, std::move(name), outcome, "it failed", "", {}};
}

TEST(CtlFailure, ExitCodesFollowTheOutcome) {
  using tmcl::Errc;
  using tmcl::Outcome;
  const auto exit = [](Errc code, Outcome outcome) {
    return failure_from(bus_error(code, outcome)).exit;
  };
  EXPECT_EQ(exit(Errc::refused_by_module, Outcome::refused), ExitCode::refused);
  EXPECT_EQ(exit(Errc::bad_argument, Outcome::not_sent), ExitCode::usage);
  EXPECT_EQ(exit(Errc::link_open_failed, Outcome::not_sent), ExitCode::not_sent);
  EXPECT_EQ(exit(Errc::module_silent, Outcome::not_sent), ExitCode::not_sent);
  EXPECT_EQ(exit(Errc::reply_timeout, Outcome::unknown), ExitCode::unknown);
  EXPECT_EQ(exit(Errc::move_interrupted, Outcome::done), ExitCode::not_reached);
}

TEST(CtlFailure, TheDaemonsErrorsGetTheSameExitCodes) {
  using tmcl::Outcome;
  const auto exit = [](int code, const char* name, Outcome outcome) {
    return failure_from(call_error(code, name, outcome)).exit;
  };
  EXPECT_EQ(exit(-32000, "refused_by_module", Outcome::refused), ExitCode::refused);
  EXPECT_EQ(exit(-32602, "out_of_range", Outcome::not_sent), ExitCode::usage);
  EXPECT_EQ(exit(-32602, "read_only", Outcome::not_sent), ExitCode::usage);
  EXPECT_EQ(exit(-32602, "beyond_soft_limit", Outcome::not_sent), ExitCode::refused);
  EXPECT_EQ(exit(-32602, "no_path", Outcome::not_sent), ExitCode::refused);
  EXPECT_EQ(exit(-32003, "axis_claimed", Outcome::not_sent), ExitCode::refused);
  EXPECT_EQ(exit(-32602, "unknown_axis", Outcome::not_sent), ExitCode::usage);
  EXPECT_EQ(exit(-32602, "unknown_parameter", Outcome::not_sent), ExitCode::usage);
  EXPECT_EQ(exit(0, "daemon_unreachable", Outcome::not_sent), ExitCode::not_sent);
  EXPECT_EQ(exit(-32000, "reply_timeout", Outcome::unknown), ExitCode::unknown);
  EXPECT_EQ(exit(-32000, "move_interrupted", Outcome::done), ExitCode::not_reached);
  EXPECT_EQ(exit(0, "cancelled", Outcome::unknown), ExitCode::interrupted);
}

TEST(CtlFailure, SaysWhatHappenedWhereAndWhatToTry) {
  const tmcl::Request request{tmcl::ModuleAddress{3}, tmcl::Command::SAP, 4, 0, 9999};
  auto error = tmcl::refusal(request, tmcl::Status::invalid_value);
  error.bus = "bench";
  const auto failure = failure_from(error);
  EXPECT_THAT(describe(failure), HasSubstr("bench"));
  EXPECT_THAT(describe(failure), HasSubstr("module 3"));
  EXPECT_THAT(describe(failure), HasSubstr("\n  "));
  const auto json = to_json(failure);
  EXPECT_EQ(json.at("name"), "refused_by_module");
  EXPECT_EQ(json.at("outcome"), "refused");
  EXPECT_EQ(json.at("status"), 4);
  EXPECT_EQ(json.at("status_name"), "invalid_value");
  EXPECT_EQ(json.at("bus"), "bench");
  EXPECT_EQ(json.at("exit_code"), 1);
}

TEST(CtlFailure, KeepsWhatTheDaemonSaidBesides) {
  auto error = call_error(-32602, "out_of_range", tmcl::Outcome::not_sent);
  error.data = {{"name", "out_of_range"}, {"param", "value"}, {"status", nullptr}};
  const auto json = to_json(failure_from(error));
  EXPECT_EQ(json.at("param"), "value");
  EXPECT_FALSE(json.contains("status"));
}

TEST(CtlNames, AnAxisWithoutANameSaysWhereItIs) {
  EXPECT_EQ(parse_axis_place("1/0")->motor, 0);
  EXPECT_EQ(parse_axis_place("2047/5")->module.address, 2047);
  EXPECT_EQ(parse_axis_place("bench:1/0")->module.bus, "bench");
  for (const auto* bad : {"x", "1", "1/", "/0", "1/0/0", "2048/0", "-1/0", "1/256", ""})
    EXPECT_FALSE(parse_axis_place(bad)) << bad;
}

TEST(CtlNames, AParameterIsANumberANameOrAnAlias) {
  EXPECT_EQ(parse_parameter(common_parameters(), "4")->name, "max_velocity");
  EXPECT_EQ(parse_parameter(common_parameters(), "Max-Velocity")->number, 4);
  EXPECT_EQ(parse_parameter(common_parameters(), "position")->number, 1);
  EXPECT_EQ(parse_parameter(common_parameters(), "77")->name, "77");
  EXPECT_THAT(parse_parameter(common_parameters(), "max_velocty").error().hint,
              HasSubstr("'max_velocity'"));
  EXPECT_EQ(parse_parameter(common_parameters(), "256").error().exit, ExitCode::usage);
}

}  // namespace
}  // namespace tmclctl
