// tmclctl profile simulate, as a user runs it: nothing else has to run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/build_paths.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

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

TEST(TmclctlProfile, SaysThatItsOutputCannotBeWritten) {
  for (const std::string to : {"/dev/full", "&-"}) {
    const auto ran = shell("models 2>&1 >" + to);
    EXPECT_EQ(ran.status, 1) << to;
    EXPECT_THAT(ran.output, HasSubstr("the output cannot be written")) << to;
  }
  const auto plot = shell(
      "profile simulate --generator tmc429 v_max=1000 a_max=500 pulse_div=2 ramp_div=3 "
      "x_target=1000 --svg /dev/full");
  EXPECT_EQ(plot.status, 1) << plot.output;
  EXPECT_THAT(plot.output, HasSubstr("cannot write /dev/full: No space left on device"));
}

// 512000 microsteps at 256000 pps, 349246 pps/s, VSTART 100 and VSTOP 200 pps: 2.73215 s by the
// equations of application note AN-035.
TEST(TmclctlProfile, SixPointAsInTheApplicationNote) {
  const auto document = simulated(
      "--generator sixpoint vstart=105 amax=3000 vmax=268435 dmax=3000 d1=3000 vstop=210 "
      "xtarget=512000");
  EXPECT_NEAR(number(document.at("duration_s")), 2.73215, 0.0005);
  EXPECT_EQ(document.at("final_position"), 512000);
  EXPECT_EQ(document.at("peak_velocity"), 268435);
}

TEST(TmclctlProfile, SixPointStopsNoSlowerThanItStarts) {
  const std::string move =
      "--generator sixpoint vstart=500 amax=3000 vmax=50000 dmax=3000 d1=1 xtarget=5000 ";
  EXPECT_EQ(simulated(move), simulated(move + "vstop=500"));
  const auto ran = shell("profile simulate " + move + "vstop=499");
  EXPECT_EQ(ran.status, 0);
  EXPECT_THAT(ran.output, HasSubstr("warning: vstop 499 is below vstart 500"));
}

// A trapezoid to 5000000 * f / 2^30 microsteps/s at 24624 * f^2 / 2^42 microsteps/s^2, as the units
// of application note AN-013 have it.
TEST(TmclctlProfile, Tmc457AsItsUnitsSay) {
  const auto document =
      simulated("--generator tmc457 v_max=5000000 a_max_d_max=24624 x_target=50000");
  const double speed = 5e6 * 16e6 / (1 << 30);
  const double acceleration = 24624 * 16e6 * 16e6 / 4398046511104.0;
  EXPECT_NEAR(number(document.at("duration_s")), 50000 / speed + speed / acceleration, 1e-4);
  EXPECT_EQ(document.at("final_position"), 50000);
  EXPECT_EQ(document.at("peak_velocity"), 5'000'000);
}

// 100000 steps, S-curve: 39195.010 cycles, with phase I of 100.707 and phase IV of 33532.262.
TEST(TmclctlProfile, Mc1451aCountsInCycles) {
  const std::string move =
      "--generator mc1451a profile=s_curve velocity=180224 acceleration=66 jerk=42950 "
      "position=100000 ";
  const auto document = simulated(move);
  EXPECT_NEAR(number(document.at("duration_cycles")), 39195.010, 1);
  EXPECT_EQ(document.at("final_position"), 100000);
  EXPECT_EQ(document.at("peak_velocity"), 180224);
  const auto& phases = document.at("phases").as_array();
  ASSERT_EQ(phases.size(), 7U);
  EXPECT_EQ(phases[1].at("name"), "II");
  EXPECT_NEAR(number(phases[1].at("start_cycles")), 100.707, 1);
  EXPECT_NEAR(number(phases[4].at("start_cycles")) - number(phases[3].at("start_cycles")),
              33532.262, 1);
  const auto in_motion = shell("profile simulate " + move + "--change 500:velocity=1000");
  EXPECT_EQ(in_motion.status, 2);
  EXPECT_EQ(in_motion.output,
            "tmclctl: --change 500:velocity=1000: velocity cannot be changed in motion\n");
  EXPECT_EQ(shell("profile simulate " + move + "f_clk=16e6").status, 2) << "it has no clock";
  EXPECT_THAT(shell("profile simulate " + move).output, HasSubstr("steps in 39195.0"));
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

// Its deceleration is far too steep: the swings get smaller so slowly that it takes hours.
TEST(TmclctlProfile, ALongOscillationIsCutOff) {
  const auto ran = shell(
      "--json profile simulate --generator tmc429 v_max=276 a_max=1 pulse_div=1 ramp_div=5 "
      "x_target=13396 last_step=r2 pmul=223 pdiv=0 2>&1 >/dev/null");
  EXPECT_EQ(ran.status, 0);
  EXPECT_THAT(ran.output, HasSubstr("it changes again and again"));
  EXPECT_THAT(ran.output, HasSubstr("only the first 10000 phases are listed"));
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
  EXPECT_EQ(complete("tmclctl profile s", 2), "simulate solve\n");
  EXPECT_EQ(complete("tmclctl profile solve distance = 2mm a", 6),
            "acceleration= acceleration_time= acceleration_distance=\n");
  EXPECT_EQ(complete("tmclctl profile solve distance =", 4), "\n");
  EXPECT_EQ(complete("tmclctl profile solve th", 3), "thirds\n");
  EXPECT_EQ(complete(simulate + "--gen", 3), "--generator\n");
  EXPECT_EQ(complete(simulate + "--generator tmc42", 4), "tmc429\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 v_m", 5), "v_min= v_max=\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 v_max = 5 mo", 8), "mode=\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 mode =", 6), "ramp soft velocity hold\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 mode = r", 7), "ramp\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 --change 0.5 : v_ma", 8), "v_max=\n");
  EXPECT_EQ(complete(simulate + "--generator tmc429 --change 0.5 : mode = s", 10), "soft\n");
  EXPECT_EQ(complete(simulate + "--model TMCM-142 max_bo", 5), "max_bow=\n");
  EXPECT_EQ(complete(simulate + "--model TMCM-142 max_velocity = 2", 7), "\n");
  EXPECT_EQ(complete(simulate + "--show v", 4), "v,a v,a,j\n");
  EXPECT_EQ(complete("tmclctl ramp --as s", 3), "sap\n");
}

}  // namespace
}  // namespace tmcl::test
