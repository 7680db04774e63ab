// profile solve: units, forms of output, and what is said when it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "command_line/options.hpp"
#include "profile/known_values.hpp"
#include "support/temp_path.hpp"
#include "tmcl/plan/profile.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::profile {
namespace {

using testing::HasSubstr;
using testing::Not;
using tmcl::plan::Quantity;
using Words = std::vector<std::string>;

class CtlSolve : public testing::Test, public test::CtlBench {
 protected:
  static Words solve(const std::string& text) {
    Words words{"profile", "solve"};
    std::istringstream in(text);
    for (std::string word; in >> word;) words.push_back(word);
    return words;
  }
  boost::json::object solved(const std::string& text) { return json(solve(text)); }
  std::string complaint(const std::string& text) {
    EXPECT_EQ(run(solve(text)), ExitCode::usage) << out;
    EXPECT_EQ(out, "");
    return err;
  }
  static double number(const boost::json::object& document, std::string_view name) {
    return document.at(name).to_number<double>();
  }
};

TEST_F(CtlSolve, PrintsTheTableAndTheCurve) {
  EXPECT_EQ(run(solve("distance=20mm total_time=600ms thirds")), ExitCode::done) << err;
  EXPECT_EQ(err, "");
  EXPECT_THAT(out, HasSubstr("distance               20 mm       given\n"));
  EXPECT_THAT(out, HasSubstr("speed                  50 mm/s"));
  EXPECT_THAT(out, HasSubstr("acceleration           250 mm/s^2"));
  EXPECT_THAT(out, HasSubstr("slew_time              0.2 s"));
  EXPECT_THAT(out, HasSubstr("velocity [mm/s]\n"));
}

TEST_F(CtlSolve, PrintsTheDistancesOfTheParts) {
  EXPECT_EQ(run(solve("speed=8mm/s acceleration=16mm/s^2 deceleration=16mm/s^2 distance=12mm")),
            ExitCode::done);
  EXPECT_THAT(out, HasSubstr("acceleration_distance  2 mm"));
  EXPECT_THAT(out, HasSubstr("slew_distance          8 mm"));
  EXPECT_THAT(out, HasSubstr("deceleration_distance  2 mm"));
  EXPECT_THAT(out, Not(HasSubstr("initial_speed")));
}

TEST_F(CtlSolve, BeginsAndEndsWithASpeed) {
  const auto document = solved(
      "initial_speed=2cm/s final_speed=60mm/s speed=100mm/s acceleration=40mm/s^2 distance=40cm "
      "symmetric");
  EXPECT_EQ(document.at("unit"), "cm");
  EXPECT_DOUBLE_EQ(number(document, "final_speed"), 6);
  EXPECT_DOUBLE_EQ(number(document, "acceleration_distance"), 12);
  EXPECT_DOUBLE_EQ(number(document, "deceleration_time"), 1);
  run(solve("initial_speed=2 speed=3 acceleration=1 deceleration=1 distance=10"));
  EXPECT_THAT(out, HasSubstr("initial_speed          2   "));
  EXPECT_THAT(complaint("initial_speed=2s speed=3 distance=10"), HasSubstr("such as mm/s"));
}

TEST_F(CtlSolve, JsonHasAllAsPlainNumbers) {
  const auto document = solved("distance=20mm total_time=600ms thirds");
  EXPECT_EQ(document.size(), tmcl::plan::every_quantity_count + 1);
  EXPECT_EQ(document.at("unit"), "mm");
  EXPECT_DOUBLE_EQ(number(document, "distance"), 20);
  EXPECT_DOUBLE_EQ(number(document, "speed"), 50);
  EXPECT_DOUBLE_EQ(number(document, "acceleration"), 250);
  EXPECT_DOUBLE_EQ(number(document, "deceleration"), 250);
  EXPECT_DOUBLE_EQ(number(document, "acceleration_time"), 0.2);
  EXPECT_DOUBLE_EQ(number(document, "slew_time"), 0.2);
  EXPECT_DOUBLE_EQ(number(document, "deceleration_time"), 0.2);
  EXPECT_DOUBLE_EQ(number(document, "total_time"), 0.6);
}

TEST_F(CtlSolve, WithoutUnitsTheyAreNull) {
  const auto document = solved("speed=8 acceleration=16 deceleration=16 distance=12");
  EXPECT_TRUE(document.at("unit").is_null());
  EXPECT_DOUBLE_EQ(number(document, "total_time"), 2);
  EXPECT_EQ(run(solve("speed=8 acceleration=16 deceleration=16 distance=12")), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("speed                  8      given\n"));
  EXPECT_THAT(out, HasSubstr("position [units]"));
}

TEST_F(CtlSolve, EveryWayToWriteAUnit) {
  for (const char* text :
       {"distance=20mm speed=50mm/s acceleration=250mm/s2 symmetric",
        "distance=20mm speed=3m/min acceleration=250mm/s^2 symmetric",
        "distance=20mm speed=0.05m/s acceleration=25cm/s/s symmetric",
        "distance=2e1mm speed=50000um/s acceleration=0.00025mm/ms2 symmetric",
        "distance=20mm speed=50 acceleration=250 symmetric",
        "distance=20 speed=50mm/s acceleration=250 symmetric",
        "distance=20mm acceleration_time=0.2 slew_time=200000us symmetric",
        "distance=20mm acceleration_time=200ms slew_time=0.2s deceleration_time=0.2"}) {
    const auto document = solved(text);
    ASSERT_EQ(err, "") << text;
    EXPECT_NEAR(number(document, "total_time"), 0.6, 1e-12) << text;
    EXPECT_NEAR(number(document, "speed"), 50, 1e-9) << text;
    EXPECT_EQ(document.at("unit"), "mm") << text;
  }
}

TEST_F(CtlSolve, LengthsOfOneKindAreConvertedToTheFirst) {
  const auto turns = solved(
      "speed=1rev/s distance=180deg acceleration=12.566370614359172rad/s2 "
      "symmetric");
  EXPECT_EQ(turns.at("unit"), "rev");
  EXPECT_DOUBLE_EQ(number(turns, "distance"), 0.5);
  EXPECT_DOUBLE_EQ(number(turns, "acceleration"), 2);
  const auto inches = solved("distance=1in total_time=1s thirds");
  EXPECT_DOUBLE_EQ(number(inches, "distance"), 1);
  EXPECT_EQ(solved("distance=1in speed=25.4mm/s slew_time=0 symmetric").at("unit"), "in");
}

TEST_F(CtlSolve, AnyWordIsALength) {
  EXPECT_EQ(solved("distance=7furlong speed=3furlong/min slew_time=0 symmetric").at("unit"),
            "furlong");
  EXPECT_THAT(complaint("distance=7furlong speed=3mm/s"), HasSubstr("'mm' cannot be converted"));
  EXPECT_THAT(complaint("distance=7mm speed=3rev/s"), HasSubstr("'rev' cannot be converted"));
}

TEST_F(CtlSolve, AUnitThatDoesNotFit) {
  EXPECT_THAT(complaint("distance=12mm/s"), HasSubstr("a unit such as mm, not 'mm/s'"));
  EXPECT_THAT(complaint("distance=12s"), HasSubstr("a unit such as mm"));
  EXPECT_THAT(complaint("speed=12mm"), HasSubstr("a unit such as mm/s"));
  EXPECT_THAT(complaint("speed=12/s"), HasSubstr("a unit such as mm/s"));
  EXPECT_THAT(complaint("speed=12mm/h"), HasSubstr("a unit such as mm/s"));
  EXPECT_THAT(complaint("acceleration=12mm/s"), HasSubstr("a unit such as mm/s^2"));
  EXPECT_THAT(complaint("total_time=12mm"), HasSubstr("none of s, ms, us and min"));
}

TEST_F(CtlSolve, WordsThatAreWrong) {
  EXPECT_THAT(complaint("dist=4"), HasSubstr("Did you mean 'distance'?"));
  EXPECT_THAT(complaint("symetric"), HasSubstr("Did you mean 'symmetric'?"));
  EXPECT_THAT(complaint("distance=abc"), HasSubstr("'abc' is no number"));
  EXPECT_THAT(complaint("distance="), HasSubstr("'' is no number"));
  EXPECT_THAT(complaint("distance=nan"), HasSubstr("'nan' is not finite"));
  EXPECT_THAT(complaint("distance=1 distance=1"), HasSubstr("given twice"));
  EXPECT_THAT(complaint("distance=-1"), HasSubstr("above 0"));
}

TEST_F(CtlSolve, WhatCannotBeSolvedSaysWhy) {
  EXPECT_THAT(complaint("distance=20mm total_time=600ms"), HasSubstr("the assumption 'thirds'"));
  EXPECT_THAT(complaint("distance=12mm speed=8mm/s acceleration=16mm/s2 deceleration=16mm/s2 "
                        "total_time=3s"),
              HasSubstr("make total_time 2 s, and it is given as 3 s: 1 s too much"));
  EXPECT_THAT(complaint("distance=100mm total_time=2s acceleration=1mm/s2 symmetric"),
              HasSubstr("total_time at least 20 s"));
}

TEST_F(CtlSolve, FailuresAreJsonToo) {
  Words words = solve("distance=20mm total_time=600ms");
  words.insert(words.begin(), "--json");
  EXPECT_EQ(run(words), ExitCode::usage);
  const auto error = boost::json::parse(out).at("error").as_object();
  EXPECT_EQ(error.at("name"), "insufficient");
  EXPECT_EQ(error.at("quantities").as_array().size(), 2U);
}

TEST_F(CtlSolve, DrawsIntoAFile) {
  const std::filesystem::path path = tmcl::test::temp_path("ctl_solve.svg");
  EXPECT_EQ(run(solve("distance=20mm total_time=600ms thirds --svg " + path.string())),
            ExitCode::done);
  EXPECT_THAT(out, Not(HasSubstr("velocity [mm/s]")));
  std::ifstream in(path);
  const std::string picture{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(picture, HasSubstr("20 mm in 0.6 s, greatest velocity 50 mm/s"));
  std::filesystem::remove(path);
  EXPECT_THAT(complaint("distance=20mm total_time=600ms thirds --svg /nowhere/x.svg"),
              HasSubstr("cannot write /nowhere/x.svg"));
}

TEST_F(CtlSolve, TheExamplesOfTheHelpWork) {
  const auto help =
      std::get<Information>(parse_options({"profile", "solve", "--help"}).value()).text;
  int examples = 0;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  tmclctl ")) continue;
    std::istringstream words(line.substr(10));
    Words example;
    for (std::string word; words >> word;) example.push_back(word);
    EXPECT_EQ(run(example), ExitCode::done) << line << err;
    ++examples;
  }
  EXPECT_GE(examples, 4);
}

TEST_F(CtlSolve, TellsTheShellItsWords) {
  const auto words =
      std::get<Information>(parse_options({"__complete", "quantities"}).value()).text;
  EXPECT_THAT(words, HasSubstr("slew_time=\n"));
  EXPECT_THAT(words, HasSubstr("initial_speed=\n"));
  EXPECT_THAT(words, HasSubstr("thirds\n"));
}

}  // namespace
}  // namespace tmclctl::profile
