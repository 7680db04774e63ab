// tmclctl profile simulate, as a user runs it: nothing else has to run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// As on a shell's command line; standard output and error come together.
Finished shell(const std::string& words) {
  return run_program({"/bin/sh", "-c", "'" TMCL_BIN_DIR "/tmclctl' " + words});
}

boost::json::object simulated(const std::string& words) {
  const auto ran = shell("--json profile simulate " + words);
  EXPECT_EQ(ran.status, 0) << ran.output;
  return boost::json::parse(ran.output).as_object();
}

double number(const boost::json::value& value) { return value.to_number<double>(); }

TEST(TmclctlProfile, NeedsNeitherBusNorDaemon) {
  const auto document = simulated(
      "--socket /nowhere --generator tmc429 v_max=1000 a_max=500 pulse_div=2 ramp_div=3 "
      "x_target=-20000 --sample 0.05,1 --change 0.01:v_max=500");
  EXPECT_EQ(document.at("final_position"), -20000);
  EXPECT_EQ(document.at("peak_velocity"), 1000);
  const auto& samples = document.at("samples").as_array();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(number(samples[0].at("v")), -500);
  EXPECT_EQ(number(samples[1].at("x")), -20000);
  EXPECT_EQ(number(samples[1].at("v")), 0);
}

TEST(TmclctlProfile, WritesCsvForOtherPrograms) {
  const auto ran = shell(
      "profile simulate --generator tmc429 v_max=1000 a_max=500 pulse_div=2 ramp_div=3 "
      "x_target=20000 --csv 0.1 | tail -n 1");
  EXPECT_EQ(ran.output, "0.4,20000,0,0\n");
}

TEST(TmclctlProfile, ErrorsAreOneCodeAndOneMessage) {
  const auto ran = shell("profile simulate --generator tmc429 v_max=2048 2>&1 >/dev/null");
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.output, "tmclctl: v_max=2048: v_max is 0..2047, not 2048\n");
  EXPECT_EQ(shell("profile simulate --generator tmc429 v_max=2048 2>/dev/null").output, "");
  const auto in_json = shell("--json profile simulate --generator tmc4 2>/dev/null");
  EXPECT_EQ(in_json.status, 2);
  EXPECT_EQ(boost::json::parse(in_json.output).at("error").at("name"), "unknown_generator");
}

TEST(TmclctlProfile, DrawsOnATerminal) {
  OnTerminal terminal({}, {"profile", "simulate", "--generator", "tmc429", "v_max=1000",
                           "a_max=500", "pulse_div=2", "ramp_div=3", "x_target=20000"});
  EXPECT_EQ(terminal.wait(), 0);
  EXPECT_THAT(terminal.output(), HasSubstr("tmc429 went from 0 to 20000 microsteps in 0.34 s"));
  EXPECT_THAT(terminal.output(), HasSubstr("⣀"));
}

TEST(TmclctlProfile, BashCompletesGeneratorsRegistersAndValues) {
  const auto complete = [](const std::string& words, int cursor) {
    const std::string script = "PATH='" TMCL_BIN_DIR "':$PATH; source '" TMCL_SOURCE_DIR
                               "/config/completions/tmclctl.bash'; compopt() { :; }; COMP_WORDS=(" +
                               words + "); COMP_CWORD=" + std::to_string(cursor) +
                               "; _tmclctl; echo \"${COMPREPLY[*]}\"";
    return run_program({"/bin/bash", "-c", script}).output;
  };
  const std::string simulate = "tmclctl profile simulate ";
  EXPECT_EQ(complete("tmclctl prof", 1), "profile\n");
  EXPECT_EQ(complete("tmclctl profile s", 2), "simulate\n");
  EXPECT_EQ(complete(simulate + "--gen", 3), "--generator\n");
  EXPECT_EQ(complete(simulate + "--generator tmc42", 4), "tmc429\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 v_m", 5), "v_min= v_max=\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 v_max = 5 mo", 8), "mode=\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 mode =", 6), "ramp soft velocity hold\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 mode = r", 7), "ramp\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 --change 0.5 : v_ma", 8), "v_max=\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 --change 0.5 : mode = s", 10), "soft\n");
}

}  // namespace
}  // namespace tmcl::test
