// Which exit code and which words an error becomes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>

#include "axis/axis_names.hpp"
#include "output/errors.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;

tmcl::Error bus_error(tmcl::Errc code, tmcl::Outcome outcome) {
  return {code, outcome, "it failed", "try again", "bench", {}, {}};
}

/// As tmcld says it.
Error call_error(int code, const char* name, tmcl::Outcome outcome) {
  return tmcl::client::error_from_json(
      {{"code", code},
       {"message", "it failed"},
       {"data", {{"name", name}, {"outcome", name_of(outcome)}, {"status", nullptr}}}});
}

TEST(CtlFailure, ExitCodesFollowTheOutcome) {
  using tmcl::Errc;
  using tmcl::Outcome;
  const auto exit = [](Errc code, Outcome outcome) {
    return exit_code_of(error_from(bus_error(code, outcome)));
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
    return exit_code_of(call_error(code, name, outcome));
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
}

TEST(CtlFailure, SaysWhatHappenedWhereAndWhatToTry) {
  const tmcl::Request request{tmcl::ModuleAddress{3}, tmcl::Command::SAP, 4, 0, 9999};
  auto error = tmcl::refusal(request, tmcl::Status::invalid_value);
  error.bus = "bench";
  const auto failure = error_from(error);
  EXPECT_THAT(error_text(failure), HasSubstr("bench"));
  EXPECT_THAT(error_text(failure), HasSubstr("module 3"));
  EXPECT_THAT(error_text(failure), HasSubstr("\n  "));
  const auto json = error_document(failure);
  EXPECT_EQ(json.at("name"), "refused_by_module");
  EXPECT_EQ(json.at("outcome"), "refused");
  EXPECT_EQ(json.at("status"), 4);
  EXPECT_EQ(json.at("status_name"), "invalid_value");
  EXPECT_EQ(json.at("bus"), "bench");
  EXPECT_EQ(json.at("exit_code"), 1);
}

TEST(CtlFailure, KeepsWhatTheDaemonSaidBesides) {
  const auto document = error_document(tmcl::client::error_from_json(
      {{"code", -32602},
       {"message", "it failed"},
       {"data", {{"name", "out_of_range"}, {"param", "value"}, {"status", nullptr}}}}));
  EXPECT_EQ(document.at("param"), "value");
  EXPECT_FALSE(document.contains("status"));
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
  EXPECT_EQ(parse_parameter(common_parameters(), "256").error().kind, ErrorKind::bad_request);
}

}  // namespace
}  // namespace tmclctl
