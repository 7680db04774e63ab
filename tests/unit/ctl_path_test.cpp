#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "support/temp_path.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string axes_of_paths = [] {
  const std::string in_mm = "unit = \"mm\"\nunits_per_revolution = 5\n";
  return test::axis_in_mm + test::axis_section("y", 1, 1, in_mm) +
         test::axis_section("left", 1, 2, in_mm) + test::axis_section("plain", 1, 3);
}();

constexpr std::uint8_t motor_of_left = 2;
constexpr std::int32_t microsteps_per_mm = 10'240;

/// Axes "x", "y" and "left" are in mm, "plain" has no unit.
class CtlPath : public testing::Test, protected test::CtlBench {
 protected:
  CtlPath() : CtlBench(axes_of_paths, "TMCM-6212") {
    for (std::uint8_t motor = 0; motor < 4; ++motor) {
      set("max_velocity", 240'000, motor);
      for (const auto* name : {"max_acceleration", "max_deceleration"}) set(name, 4'999'922, motor);
    }
  }
  ~CtlPath() override { std::filesystem::remove(path); }

  std::string file(const std::string& text) const {
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  const std::string path = tmcl::test::temp_path("ctl_path_test");
};

TEST_F(CtlPath, CheckTellsWhatAPathIs) {
  const auto square = file("G1 X10 F1200\nG1 Y10\nG4 P1\nG1 X0 Y0\n");
  EXPECT_EQ(run({"path", "check", square, "--velocity", "20", "--acceleration", "500"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(out, HasSubstr("34.1421 units"));
  EXPECT_THAT(out, HasSubstr("X     0     10  20"));
  EXPECT_THAT(out, HasSubstr("end of line 2"));
  const auto document = json({"path", "check", square});
  EXPECT_EQ(document.at("legs"), 3);
  EXPECT_EQ(document.at("axes").at(1).at("greatest").to_number<double>(), 10);
  EXPECT_EQ(document.at("slowest_corners").at(0).at("speed").to_number<double>(), 0);
}

TEST_F(CtlPath, CheckListsWhatAMachineSwitchesAndHowOftenItWaits) {
  const auto part = file("M3\nG1 X10 F1200\nM0\nG55 X20 M3\nM0\nM8\n");
  const auto machine = tmcl::test::temp_path("machine.toml");
  std::ofstream(machine) << "[daemon]\nsocket = \"/tmp/s\"\n[[bus]]\nname = \"bench\"\n"
                            "link = \"can:can0\"\n[path]\nm3 = \"bench:1 output 0 1\"\n"
                            "m5 = \"bench:1 output 0 0\"\ng55 = {x = 100}\n";
  const std::vector<std::string> check{"path", "check", part, "--machine", machine};
  EXPECT_EQ(run(check), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("M3    bench:1 output 0 1  2      line 1\n"
                             "M5    bench:1 output 0 0  1      line 6\n"));
  EXPECT_THAT(out, HasSubstr("\nwaits 2 times at M0 until 'tmclctl path resume'\n"));
  EXPECT_THAT(err, HasSubstr("line 6: M8 is not carried out"));
  EXPECT_THAT(err, Not(HasSubstr("G55")));
  const auto document = json(check);
  EXPECT_EQ(document.at("waits"), 2);
  EXPECT_EQ(document.at("words").as_array().size(), 2U);
  EXPECT_EQ(document.at("axes").at(0).at("greatest").to_number<double>(), 120);
  // Without a machine nothing is switched.
  EXPECT_TRUE(json({"path", "check", part}).at("words").as_array().empty());
  EXPECT_THAT(err, HasSubstr("line 1: M3 is not carried out"));
  std::filesystem::remove(machine);
}

TEST_F(CtlPath, AMachineThatIsWronglyConfiguredIsNamed) {
  const auto part = file("M3\nG1 X10 F1200\n");
  const auto machine = tmcl::test::temp_path("machine.toml");
  std::ofstream(machine) << "[daemon]\nsocket = \"/tmp/s\"\n[path]\nm3 = \"far:1 output 0 1\"\n";
  EXPECT_EQ(run({"path", "check", part, "--machine", machine}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(":4:6: 'm3': there is no bus 'far'."));
  std::filesystem::remove(machine);
  EXPECT_EQ(run({"path", "check", part, "--machine", machine}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(machine));
}

TEST_F(CtlPath, CheckSaysWhatAShaperCostsAndGains) {
  const auto part = file("G1 X10 F1200\nG1 Y10\n");
  const std::vector<std::string> shaped{"path", "check",       part,  "--shape",
                                        "zv",   "--resonance", "12Hz"};
  EXPECT_EQ(run(shaped), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("shaped by zv for 12 Hz: 0.0417 s longer, and at most "));
  EXPECT_THAT(out, HasSubstr("the load of Y swings by "));
  EXPECT_THAT(err, HasSubstr("warning: shaped, the path leaves its corners by more than the "
                             "tolerance of 0.05: a lower --acceleration, "));
  const auto document = json(shaped);
  EXPECT_EQ(document.at("shaping").at("shaper"), "zv");
  EXPECT_EQ(document.at("warnings").as_array().size(), 1U);
  // A dwell is where it is.
  const auto dwells = file("G1 X10 F1200\nG4 P0.1\nG1 Y10\n");
  EXPECT_EQ(run(shaped), ExitCode::done);
  EXPECT_EQ(err, "") << dwells;
}

TEST_F(CtlPath, CheckSaysWhatAJerkCostsAndGains) {
  const auto part = file("G1 X10 F1200\nG1 Y10\n");
  std::vector<std::string> smooth{"path", "check", part, "--acceleration", "400", "--jerk", "4800"};
  EXPECT_EQ(run(smooth), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("with a jerk of 4800 at most: 0."));
  EXPECT_THAT(out, Not(HasSubstr("the load of")));
  EXPECT_EQ(err, "");
  smooth.insert(smooth.end(), {"--resonance", "12Hz"});
  EXPECT_EQ(run(smooth), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("the load of Y swings by "));
  const auto limit = json(smooth).at("jerk").as_object();
  EXPECT_EQ(limit.at("jerk"), 4800);
  EXPECT_EQ(limit.at("resonance_hz"), 12);
  const auto& y = limit.at("axes").at(1);
  EXPECT_LT(y.at("swing").to_number<double>(), 0.2 * y.at("unlimited_swing").to_number<double>());
  // It is what is shaped.
  smooth.insert(smooth.end(), {"--shape", "zv"});
  EXPECT_EQ(run(smooth), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("with a jerk of 4800 at most: "));
  EXPECT_THAT(out, HasSubstr("shaped by zv for 12 Hz: 0.0417 s longer"));
}

TEST_F(CtlPath, AJerkIsNotForLegsAndTables) {
  const auto part = file("G1 X10 F1200\n");
  EXPECT_EQ(run({"path", "check", part, "--jerk", "4800", "--legs"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--legs and --jerk exclude each other"));
  const auto table = file("x,time\n0,0\n5,1\n");
  EXPECT_EQ(run({"path", "check", table, "--jerk", "4800"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("a table with times is passed as it says, with any jerk"));
}

TEST_F(CtlPath, AShaperNeedsAResonance) {
  const auto part = file("G1 X10 F1200\n");
  const auto objection = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"path", "check", part});
    EXPECT_EQ(run(more), ExitCode::usage);
    return err;
  };
  EXPECT_THAT(objection({"--shape", "zv"}), HasSubstr("--shape needs --resonance"));
  EXPECT_THAT(objection({"--resonance", "12"}), HasSubstr("--resonance needs --shape or --jerk"));
  EXPECT_THAT(objection({"--damping", "0"}), HasSubstr("--damping needs --resonance"));
  EXPECT_THAT(objection({"--shape", "zvx", "--resonance", "12"}), HasSubstr("none of zv, zvd"));
  EXPECT_THAT(objection({"--shape", "zv", "--resonance", "12", "--legs"}), HasSubstr("exclude"));
}

TEST_F(CtlPath, WhatIsNotCarriedOutIsAWarning) {
  const auto part = file("T1 M6 S9 M3\nG1 X10 F1200\nX20 S5\n");
  EXPECT_EQ(run({"path", "check", part}), ExitCode::done) << err;
  EXPECT_THAT(err, HasSubstr("warning: line 1: S is not carried out\n"));
  const auto document = json({"path", "check", part});
  EXPECT_EQ(document.at("warnings").as_array().size(), 4U);
  EXPECT_EQ(document.at("warnings").at(1), "line 1: M6 is not carried out");
  EXPECT_EQ(json({"path", "check", file("G1 X10 F1200\n")}).at("warnings").as_array().size(), 0U);
}

TEST_F(CtlPath, UnknownWordsAreSkippedIfAskedFor) {
  const auto part = file("G41 D1\nG1 X10 E5 F1200\nG0 X#1\n");
  EXPECT_EQ(run({"path", "check", part}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(":1:1: G41 is not known here"));
  EXPECT_THAT(err, HasSubstr(":2:8: 'E5' is not known here"));
  EXPECT_EQ(run({"path", "check", part, "--lenient"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(":3:4: a number is missing"));
  EXPECT_THAT(err, Not(HasSubstr("G41")));
  const auto known = file("G41 D1\nG1 X10 E5 F1200\n");
  EXPECT_EQ(run({"path", "check", known, "--lenient"}), ExitCode::done) << err;
  EXPECT_THAT(err, HasSubstr("warning: line 2: 'E5' is not known here; skipped"));
  EXPECT_EQ(json({"path", "check", known, "--lenient"}).at("warnings").as_array().size(), 3U);
}

TEST_F(CtlPath, LegsAreToldAsRampGeneratorsTakeThem) {
  const auto corner = file("G1 X10 F1200\nG1 Y10\n");
  const auto document = json({"path", "check", corner, "--velocity", "20", "--acceleration", "500",
                              "--legs", "--microsteps-per-unit", "100"});
  const auto& first = document.at("leg_table").at(0);
  EXPECT_EQ(first.at("t1_s").to_number<double>(), 0);
  EXPECT_NEAR(first.at("t2_s").to_number<double>(), 0.04, 1e-9);  // 20 / 500
  EXPECT_GT(first.at("t3_s").to_number<double>(), 0.45);
  EXPECT_EQ(first.at("t4_s"), document.at("leg_table").at(1).at("t1_s"));
  const auto& x = first.at("axes").at(0);
  EXPECT_EQ(x.at("axis"), "X");
  EXPECT_NEAR(x.at("vmax").to_number<double>(), 20, 1e-9);
  EXPECT_NEAR(x.at("amax").to_number<double>(), 500, 1e-9);
  EXPECT_EQ(x.at("microsteps").at("vmax"), 2000);
  EXPECT_EQ(x.at("microsteps").at("dmax"), 50'000);
  // f / 2^24 and f^2 / 2^41.
  EXPECT_EQ(x.at("registers").at("target"), 1000);
  EXPECT_EQ(x.at("registers").at("vmax"), 2097);
  EXPECT_EQ(x.at("registers").at("amax"), 429);
  EXPECT_EQ(x.at("registers").at("vstart"), 0);
  EXPECT_EQ(document.at("leg_table").at(1).at("axes").at(1).at("registers").at("vstop"), 10);
  const auto slower = json({"path", "check", corner, "--velocity", "20", "--acceleration", "500",
                            "--legs", "--microsteps-per-unit", "100", "--clock", "12000000"});
  const auto& other = slower.at("leg_table").at(0).at("axes").at(0).at("registers");
  EXPECT_EQ(other.at("vmax"), 2796);
  EXPECT_EQ(other.at("amax"), 764);
  EXPECT_EQ(run({"path", "check", corner, "--legs"}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("TO (UNITS)"));
  EXPECT_THAT(out, Not(HasSubstr("MICROSTEPS")));
  EXPECT_EQ(run({"path", "check", file("t,x\n0,0\n1,5\n"), "--legs"}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("has no legs"));
}

// What the table writes is what the chip needs to go along the path.
TEST_F(CtlPath, LegsAreATableThatDrivesTheChip) {
  using tmcl::ramp::SixPoint;
  const auto corner = file("G1 X10 Y4 F1200\nG1 Y10\nG1 X-3\n");
  const std::vector<std::string> words{"path",       "check",  corner,
                                       "--velocity", "20",     "--acceleration",
                                       "500",        "--legs", "--microsteps-per-unit",
                                       "1000"};
  auto as_c = words;
  as_c.insert(as_c.end(), {"--as", "c"});
  ASSERT_EQ(run(as_c), ExitCode::done) << err;
  const auto table = out;
  const auto legs = json(words).at("leg_table").as_array();
  std::array<SixPoint, 2> axes;
  const std::regex row(R"(\{(\d), 0x(\w+), (-?\d+)\})");
  std::size_t writes = 0;
  for (auto found = std::sregex_iterator(table.begin(), table.end(), row);
       found != std::sregex_iterator(); ++found) {
    auto& axis = axes.at(std::stoul((*found)[1]));
    const auto address = std::stoul((*found)[2], nullptr, 16);
    const auto info = std::ranges::find_if(SixPoint::registers(), [&](const auto& one) {
      return one.bits.are_at(static_cast<std::uint8_t>(address));
    });
    ASSERT_NE(info, SixPoint::registers().end());
    const auto name = static_cast<SixPoint::Register>(info - SixPoint::registers().begin());
    EXPECT_TRUE(axis.write(name, std::stoll((*found)[3])));
    if (++writes % 12 != 0) continue;
    // All of a leg is written.
    const auto& leg = legs.at(writes / 12 - 1).as_object();
    for (std::size_t i = 0; i < 2; ++i) {
      const auto duration = leg.at("t4_s").to_number<double>() - leg.at("t1_s").to_number<double>();
      const auto ticks = SixPoint::ticks_per_second(16e6) * (duration * 1.1 + 0.01);
      axes.at(i).advance_to(axes.at(i).tick() + static_cast<tmcl::ramp::Tick>(ticks));
      EXPECT_EQ(axes.at(i).motion().position,
                leg.at("axes").at(i).at("registers").at("target").to_number<std::int64_t>());
    }
  }
  EXPECT_EQ(writes, 3U * 2 * 6);
  EXPECT_EQ(run({"path", "check", corner, "--as", "c"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--as needs --legs"));
  as_c[2] = file("t,x\n0,0\n1,5\n");
  EXPECT_EQ(run(as_c), ExitCode::usage) << out;
  EXPECT_THAT(err, HasSubstr("has no legs"));
}

/// Rows of numbers below a heading.
struct Rows {
  std::vector<std::string> heading;
  std::vector<std::vector<double>> numbers;

  explicit Rows(const std::string& csv) {
    std::istringstream lines(csv);
    std::string line;
    for (bool first = true; std::getline(lines, line); first = false) {
      std::istringstream cells(line);
      if (!first) numbers.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) {
        if (first) heading.push_back(cell);
        if (!first) numbers.back().push_back(std::stod(cell));
      }
    }
  }
};

// Arcs in another plane, and of several turns; two movements of one line.
TEST_F(CtlPath, RowsSayHowFarTheyAreFromArcsInAnyPlane) {
  for (const std::string text : {"F1200 G18 G2 X0 Z0 Y6 I-5 K0 P3\n", "F600 G1 X3\nG28 X9 Y5\n"}) {
    EXPECT_EQ(run({"path", "check", file(text), "--csv", "-", "--step", "0.01"}), ExitCode::done)
        << err;
    const Rows rows(out);
    EXPECT_EQ(rows.heading.back(), "off");
    double worst = 0;
    for (const auto& row : rows.numbers) worst = std::max(worst, row.back());
    EXPECT_GT(rows.numbers.size(), 30U);
    EXPECT_LT(worst, 0.0501) << text;
  }
}

// Each column is the change of the one before it.
TEST_F(CtlPath, RowsHaveTheMotionOfEachAxis) {
  const auto corner = file("G1 X10 F1200\nG1 Y10\n");
  EXPECT_EQ(run({"path", "check", corner, "--velocity", "20", "--acceleration", "500", "--csv", "-",
                 "--step", "0.0005"}),
            ExitCode::done)
      << err;
  const Rows rows(out);
  EXPECT_THAT(rows.heading, testing::ElementsAre("t", "X_x", "X_v", "X_a", "X_j", "Y_x", "Y_v",
                                                 "Y_a", "Y_j", "off"));
  ASSERT_GT(rows.numbers.size(), 1000U);
  for (std::size_t i = 1; i < rows.numbers.size(); ++i) {
    const auto& before = rows.numbers[i - 1];
    const auto& row = rows.numbers[i];
    for (const std::size_t x : {std::size_t{1}, std::size_t{5}}) {
      const double mean = (before[x + 1] + row[x + 1]) / 2;
      EXPECT_NEAR(row[x] - before[x], mean * 0.0005, 0.0005 * 3) << row[0];
      if (before[x + 2] == row[x + 2] && row[x + 2] != 0) {
        EXPECT_NEAR(row[x + 1] - before[x + 1], row[x + 2] * 0.0005, 1e-6) << row[0];
      }
      EXPECT_LE(std::abs(row[x + 2]), 500 + 1e-9);
    }
    EXPECT_EQ(row[9], 0) << row[0];
  }
  EXPECT_THAT(rows.numbers.back(), testing::ElementsAre(testing::_, 10, 0, 0, 0, 10, 0, 0, 0, 0));
}

// The chords of a circle may be off it by a quarter of the tolerance.
TEST_F(CtlPath, RowsTellHowFarChordsAreOffTheirArc) {
  const auto circle = file("G2 X0 Y0 I10 J0 F1200\n");
  const auto other = path + ".csv";
  EXPECT_EQ(run({"path", "check", circle, "--tolerance", "0.4", "--show", "x", "--csv", other}),
            ExitCode::done)
      << err;
  EXPECT_THAT(out, HasSubstr("units in"));
  std::ostringstream text;
  text << std::ifstream(other).rdbuf();
  std::filesystem::remove(other);
  const Rows rows(text.str());
  EXPECT_THAT(rows.heading, testing::ElementsAre("t", "X_x", "Y_x", "off"));
  double most = 0;
  for (const auto& row : rows.numbers) {
    EXPECT_NEAR(row[3], 10 - std::hypot(row[1] - 10, row[2]), 1e-8) << row[0];
    most = std::max(most, row[3]);
  }
  EXPECT_LE(most, 0.1);
  EXPECT_GT(most, 0.02);
}

// Cubics that meet the rows with a common velocity leave the lines between them.
TEST_F(CtlPath, RowsOfATableWithTimesHaveAJerk) {
  const auto table = file("t,x,y\n0,0,0\n1,5,1\n2,5,5\n3,0,5\n");
  EXPECT_EQ(run({"path", "check", table, "--csv", "-", "--step", "0.01"}), ExitCode::done) << err;
  const Rows rows(out);
  const std::array<std::array<double, 2>, 4> corners{{{0, 0}, {5, 1}, {5, 5}, {0, 5}}};
  double most = 0;
  for (std::size_t i = 1; i < rows.numbers.size(); ++i) {
    const auto& row = rows.numbers[i];
    const auto line = std::min<std::size_t>(static_cast<std::size_t>(row[0]), 2);
    double nearest = 1e9;
    for (int k = 0; k <= 10'000; ++k) {
      const double part = k / 1e4;
      nearest = std::min(
          nearest, std::hypot(row[1] - std::lerp(corners[line][0], corners[line + 1][0], part),
                              row[5] - std::lerp(corners[line][1], corners[line + 1][1], part)));
    }
    EXPECT_NEAR(row[9], nearest, 1e-3) << row[0];
    most = std::max(most, row[9]);
    if (i % 100 > 1) {
      EXPECT_NEAR(row[3] - rows.numbers[i - 1][3], row[4] * 0.01, 1e-6) << row[0];
    }
  }
  EXPECT_GT(most, 0.1);
  EXPECT_EQ(run({"path", "check", table, "--csv", "-", "--step", "1e-7"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("1000000 at most"));
  EXPECT_EQ(run({"--json", "path", "check", table, "--csv", "-"}), ExitCode::usage);
}

TEST_F(CtlPath, RampsAreToldInWholeNumbersOfRegisters) {
  const auto line = file("G1 X20 Y5 F1200\n");
  EXPECT_EQ(run({"path", "check", line, "--velocity", "20", "--acceleration", "500", "--legs",
                 "--microsteps-per-unit", "10240"}),
            ExitCode::done);
  EXPECT_THAT(out, HasSubstr("XTARGET"));
  EXPECT_THAT(out, HasSubstr(", 1 leg\n"));
  EXPECT_THAT(out, HasSubstr("204800")) << "the target of X";
  EXPECT_THAT(out, HasSubstr("5120000")) << "its acceleration in microsteps";
  EXPECT_THAT(out, HasSubstr("43980")) << "and in the register";
  EXPECT_THAT(out, Not(testing::ContainsRegex("[0-9]e[+][0-9]")));
  EXPECT_EQ(err, "");
  EXPECT_EQ(run({"path", "check", line, "--velocity", "20", "--acceleration", "5000", "--legs",
                 "--microsteps-per-unit", "10240"}),
            ExitCode::done);
  EXPECT_THAT(err, HasSubstr("line 1: amax of X would be 439805, and its register holds 65535 at "
                             "most; with fewer microsteps it fits: --microsteps-per-unit 1280"));
}

TEST_F(CtlPath, ATableIsKnownByItsFirstLine) {
  const auto table = file("# where when\nt,x,y\n0,0,0\n1,5,5\n");
  EXPECT_EQ(json({"path", "check", table}).at("duration_s").to_number<double>(), 1);
  EXPECT_EQ(run({"path", "check", table, "--velocity", "2"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("line 4: too fast for axis x"));
}

TEST_F(CtlPath, ProblemsHaveTheirPlaces) {
  EXPECT_EQ(run({"path", "check", file("G1 X1 F600\nG99\n")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(path + ":2:1: "));
  EXPECT_EQ(run({"path", "check", file("M2\n")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("moves nothing"));
}

TEST_F(CtlPath, TheGatewayIsToldToSkipUnknownWords) {
  const auto line = file("G1 X10 E5 F600\n");
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=left", "--lenient", "--dry-run"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(calls_of("path.plan"), testing::ElementsAre(HasSubstr(R"("lenient":true)")));
  EXPECT_THAT(err, HasSubstr("warning: line 1: 'E5' is not known here; skipped"));
  const auto document = json({"path", "run", line, "--axis", "X=left", "--lenient", "--dry-run"});
  EXPECT_EQ(document.at("warnings").as_array().size(), 1U);
}

TEST_F(CtlPath, APathIsPlannedOnceAndRunAsItWasPlanned) {
  const auto line = file("G1 X10 F600\n");
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=left", "--feed", "3"}), ExitCode::done) << err;
  EXPECT_THAT(calls,
              testing::ElementsAre(R"(path.stage {"offset":0,"data":"47312058313020463630300a"})",
                                   R"(path.plan {"axes":["left"],"file_axes":["X"],)"
                                   R"("bytes":12,"format":"gcode","mode":"velocity",)"
                                   R"("tolerance":5E-2,"feed":3E0,"period_ms":5,)"
                                   R"("name":")" +
                                       line + R"("})",
                                   R"(path.run {"plan":1,"to_start":true})"));
  EXPECT_EQ(get("actual_position", motor_of_left), 10 * microsteps_per_mm);
  EXPECT_THAT(out, testing::ContainsRegex("^AXIS  LARGEST ERROR  RMS     READINGS\n"
                                          "left  0\\.[0-9]{4}         0\\.[0-9]{4}  [0-9]+\n"
                                          "seen at most 0\\.[0-9]{4} off the path, at "));
  EXPECT_THAT(out, testing::ContainsRegex("\n[0-9]+ updates in 3\\.3[0-9]+ s, one every "));
  EXPECT_EQ(err, "");
}

TEST_F(CtlPath, QuantitiesWithTheirUnitsAreHandedThrough) {
  const auto line = file("G1 X10 F600\n");
  EXPECT_EQ(run({"path", "run", line, "--dry-run", "--velocity", "20mm/s", "--acceleration",
                 "500 mm/s2", "--feed", "12"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(calls_of("path.plan"),
              testing::ElementsAre(
                  HasSubstr(R"("velocity":"20mm/s","acceleration":"500 mm/s2","feed":1.2E1)")));
}

// Line 2 is shorter than what it takes to load line 3.
TEST_F(CtlPath, ADryRunShowsAndDrawsWhatWasPlanned) {
  const auto line = file("G1 X10 Y-1 F600\nG1 X10.00001\nG1 X9 Y3\n");
  const auto svg = path + ".svg";
  EXPECT_EQ(run({"path", "run", line, "--dry-run", "--svg", svg}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("14.173 units in 1.457 s, 3 legs\n"));
  EXPECT_THAT(out, HasSubstr("Y     -1    3   9.70142\n"));
  EXPECT_THAT(out, testing::ContainsRegex("velocity  0\\.0[0-9]{3} +[01]\\.[0-9]{3} s +[0-9.]+ ms "
                                          "+kept\n"
                                          "segments  0\\.0[0-9]{3} +[01]\\.[0-9]{3} s +[0-9.]+ ms "
                                          "+exceeded\n"
                                          "position  - +- +- +line 3: to load it takes "));
  EXPECT_TRUE(std::filesystem::remove(svg));
  const auto document = json({"path", "run", line, "--dry-run"});
  EXPECT_EQ(document.at("axes").at(0).at("axis"), "X");
  EXPECT_THAT(std::string(document.at("expected").at(2).at("refused").as_string()),
              HasSubstr("line 3: to load it takes "));
  EXPECT_EQ(std::string(document.at("file").as_string()), line);
  EXPECT_THAT(calls_of("path.run"), testing::IsEmpty());
  EXPECT_EQ(get("actual_position"), 0);
}

TEST_F(CtlPath, WhatCannotBePlannedIsExplained) {
  const auto line = file("G1 X10 F600\n");
  EXPECT_EQ(run({"path", "run", line, "--axis", "x"}), ExitCode::usage);
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=x", "--mode", "fast"}), ExitCode::usage);
  EXPECT_THAT(calls, testing::IsEmpty());
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=plain"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--per-turn"));
  EXPECT_EQ(run({"path", "run", file("G1 X10 F600\nG99\n")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(path + ":2:1: G99 is not known here\n"));
  EXPECT_EQ(run({"path", "run", file("G1 A10 F600\n")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--axis A=NAME"));
}

TEST_F(CtlPath, CtrlCLetsTheGatewayStop) {
  host.press_ctrl_c_after(std::chrono::seconds(1));
  EXPECT_EQ(run({"path", "run", file("G1 X10 Y1 F300\n"), "--axis", "X=left"}),
            ExitCode::interrupted);
  EXPECT_EQ(calls.back(), R"(path.stop {"axes":["left","y"]})");
  EXPECT_THAT(err, HasSubstr("stopped before the end of the path"));
  EXPECT_EQ(get("actual_velocity", motor_of_left), 0);
  EXPECT_GT(get("actual_position", motor_of_left), microsteps_per_mm);
  EXPECT_LT(get("actual_position", motor_of_left), 9 * microsteps_per_mm);
}

TEST_F(CtlPath, AStopByAnotherClientEndsItEarly) {
  other_after(std::chrono::seconds(1), "axis.stop", {{"axis", "left"}});
  EXPECT_EQ(run({"path", "run", file("G1 X10 F300\n"), "--axis", "X=left"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("left was stopped by another client"));
}

TEST_F(CtlPath, ALostLinkEndsItEarlyAndWhatWasNotGivenBackIsAWarning) {
  after(std::chrono::seconds(1), [&] { cut_wires("its plug is out"); });
  EXPECT_EQ(run({"path", "run", file("G1 X10 F300\n"), "--axis", "X=left"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("tmclctl: warning: left could not be stopped\n"));
  EXPECT_THAT(err, HasSubstr("tmclctl: warning: parameter 4 of left was 240000 before: "));
  EXPECT_THAT(err, HasSubstr("axis 'left' could not be stopped and may still move"));
}

TEST_F(CtlPath, AnAxisThatMovesBeforeItBeginsIsRefused) {
  // Between the plan and the run.
  amend("path.plan", [&](boost::json::object&) {
    other("axis.rotate", {{"axis", "left"}, {"velocity_internal", 1000}});
  });
  EXPECT_EQ(run({"path", "run", file("G1 X10 F300\n"), "--axis", "X=left"}), ExitCode::refused);
  EXPECT_EQ(err, "tmclctl: left is moving\n");
}

}  // namespace
}  // namespace tmclctl
