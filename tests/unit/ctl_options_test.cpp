// What tmclctl makes of a command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "command_line/options.hpp"
#include "support/build_paths.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

template <class Verb>
Verb parsed(const Words& words) {
  const auto result = parse_options(words);
  if (!result) throw std::runtime_error(error_text(result.error()));
  return std::any_cast<Verb>(std::get<Options>(*result).verb.said);
}

Error failure(const Words& words) {
  const auto result = parse_options(words);
  if (result) throw std::runtime_error("it was understood");
  return result.error();
}

std::string information(const Words& words) {
  return std::get<Information>(parse_options(words).value()).text;
}

TEST(CtlOptions, NegativeNumbersAreNumbers) {
  EXPECT_EQ(parsed<verb::Rotate>({"rotate", "x", "-500"}).velocity, "-500");
  EXPECT_EQ(parsed<verb::Move>({"move", "x", "-1000"}).position, "-1000");
  EXPECT_EQ(parsed<verb::Move>({"move", "x", "-1000", "--by"}).position, "-1000");
  EXPECT_EQ(parsed<verb::Move>({"move", "--by", "x", "-1"}).position, "-1");
  EXPECT_EQ(parsed<verb::Set>({"set", "x", "1", "-2147483648"}).value, "-2147483648");
  EXPECT_EQ(parsed<verb::Plot>({"plot", "x", "--to", "-5"}).to, "-5");
  EXPECT_EQ(parsed<verb::Plot>({"plot", "x", "--by=-5"}).by, "-5");
  EXPECT_EQ(parsed<verb::Raw>({"raw", "1", "SAP", "4", "0", "-7"}).value, -7);
}

TEST(CtlOptions, NumbersAreWhole) {
  EXPECT_EQ(parsed<verb::Raw>({"raw", "1", "SAP", "4", "0", "010"}).value, 10);
  EXPECT_EQ(parsed<verb::Raw>({"raw", "1", "SAP", "4", "0", "+10"}).value, 10);
  EXPECT_EQ(parsed<verb::Raw>({"raw", "1", "SAP", "4", "$2", "0x43"}).value, 0x43);
  EXPECT_EQ(parsed<verb::Raw>({"raw", "1", "SAP", "4", "$2", "0x43"}).motor, 2);
  EXPECT_EQ(parsed<verb::Raw>({"raw", "1", "SAP", "4", "0", "0xffffffff"}).value, -1);
  EXPECT_EQ(exit_code_of(failure({"raw", "1", "SAP", "4", "0x100", "0"})), ExitCode::usage);
  for (const auto* bad : {"1.5", "", "0x", "0xG", "$", "0x100000000", "0x1.5", "ten", "1e3", "nan"})
    EXPECT_EQ(exit_code_of(failure({"raw", "1", "SAP", "4", "0", bad})), ExitCode::usage) << bad;
  EXPECT_THAT(failure({"raw", "1", "SAP", "4", "0", "2147483648"}).message,
              HasSubstr("2147483647"));
  EXPECT_THAT(failure({"raw", "2048", "GAP", "1", "0", "0"}).message, HasSubstr("2047"));
  EXPECT_EQ(exit_code_of(failure({"move", "x", "--"})), ExitCode::usage);
}

TEST(CtlOptions, QuantitiesAreKeptAsTheyWereTyped) {
  EXPECT_EQ(parsed<verb::Move>({"move", "x", "10mm"}).position, "10mm");
  EXPECT_EQ(parsed<verb::Move>({"move", "x", "-1.5 rev", "--by"}).position, "-1.5 rev");
  EXPECT_EQ(parsed<verb::Rotate>({"rotate", "x", "+2.5e2rpm"}).velocity, "+2.5e2rpm");
  EXPECT_EQ(parsed<verb::Set>({"set", "x", "5", "1e6pps/s"}).value, "1e6pps/s");
  EXPECT_EQ(parsed<verb::Plot>({"plot", "x", "--by", "-3.5mm"}).by, "-3.5mm");
  const auto ramp = parsed<verb::Ramp>(
      {"ramp", "x", "--velocity", "2rps", "--acceleration", "3rps/s", "--dry-run"});
  EXPECT_EQ(ramp.velocity, "2rps");
  EXPECT_EQ(ramp.acceleration, "3rps/s");
  EXPECT_TRUE(ramp.dry_run);
  EXPECT_THAT(failure({"ramp", "x", "--velocity", "2rps"}).message, HasSubstr("--acceleration"));
  EXPECT_THAT(failure({"convert", "2rps"}).message, HasSubstr("--model"));
  EXPECT_THAT(failure({"convert", "--model", "1110", "2rps", "--microsteps", "3"}).message,
              HasSubstr("power of two"));
}

TEST(CtlOptions, GlobalOptionsMayStandAnywhere) {
  const auto result = parse_options({"get", "1/0", "4", "--direct", "can:can0", "--json"});
  const auto options = std::get<Options>(result.value());
  EXPECT_TRUE(options.json);
  EXPECT_EQ(options.where.direct, "can:can0");
}

TEST(CtlOptions, ScansTheWholeRangeOrAPart) {
  EXPECT_EQ(parsed<verb::Scan>({"scan"}).range.last, 255);
  const auto range = parsed<verb::Scan>({"scan", "--addresses", "3-20"}).range;
  EXPECT_EQ(range.first, 3);
  EXPECT_EQ(range.last, 20);
  EXPECT_EQ(parsed<verb::Scan>({"scan", "--addresses", "7"}).range.last, 7);
  EXPECT_EQ(exit_code_of(failure({"scan", "--addresses", "20-3"})), ExitCode::usage);
  EXPECT_THAT(failure({"scan", "--addresses", "20-3"}).message,
              testing::HasSubstr("20-3 goes down; meant is perhaps 3-20"));
}

TEST(CtlOptions, AWordThatIsNoVerbIsNotTakenForOneThatMoves) {
  for (const auto* word : {"version", "list", "tune", "jog", "settings", "status", "halt"}) {
    const auto hint = failure({word}).hint;
    EXPECT_THAT(hint, Not(HasSubstr("Did you mean"))) << word;
  }
  EXPECT_THAT(failure({"version"}).hint, HasSubstr("tmclctl --version"));
  EXPECT_THAT(failure({"halt"}).hint, HasSubstr("tmclctl stop --all"));
  EXPECT_THAT(failure({"stop", "--everything"}).hint, HasSubstr("Everything still moves"));
  EXPECT_THAT(failure({"store", "x", "4", "--all"}).hint, Not(HasSubstr("--url")));
}

TEST(CtlOptions, ADrawingIsSvg) {
  for (const auto* name : {"x.png", "X.PNG", "a/b.pdf", "c.jpeg"}) {
    const auto wrong = failure({"plot", "x", "--svg", name});
    EXPECT_EQ(exit_code_of(wrong), ExitCode::usage);
    EXPECT_THAT(wrong.message, HasSubstr(".svg")) << name;
  }
  EXPECT_EQ(parsed<verb::Plot>({"plot", "x", "--svg", "x.svg"}).svg, "x.svg");
  EXPECT_EQ(parsed<verb::Plot>({"plot", "x", "--svg", "/dev/stdout"}).svg, "/dev/stdout");
}

TEST(CtlOptions, SuggestsWhatWasMeant) {
  EXPECT_THAT(failure({"mvoe", "x", "1"}).hint, HasSubstr("'move'"));
  EXPECT_THAT(failure({"move", "x", "1", "--wiat"}).hint, HasSubstr("'--wait'"));
  EXPECT_THAT(failure({"--sokcet", "x", "axes"}).hint, HasSubstr("'--socket'"));
}

TEST(CtlOptions, SaysWhatIsWrong) {
  EXPECT_THAT(failure({}).message, HasSubstr("verb is missing"));
  EXPECT_THAT(failure({"get", "x"}).message, HasSubstr("PARAM"));
  EXPECT_THAT(failure({"get", "x", "4", "5"}).message, HasSubstr("'5'"));
  EXPECT_THAT(failure({"stop"}).message, HasSubstr("--all"));
  EXPECT_THAT(failure({"stop", "x", "--all"}).message, HasSubstr("--all"));
  EXPECT_THAT(failure({"move", "x", "1", "--timeout", "3"}).message, HasSubstr("--wait"));
  EXPECT_THAT(failure({"plot", "x", "--to", "1", "--by", "1"}).message, HasSubstr("--by"));
  EXPECT_THAT(failure({"--socket", "a", "--direct", "can:b", "axes"}).message,
              HasSubstr("--direct"));
  EXPECT_THAT(failure({"--config", "a", "axes"}).message, HasSubstr("--config goes with --direct"));
  EXPECT_THAT(failure({"--reply-timeout", "500", "axes"}).message,
              HasSubstr("--reply-timeout goes with --direct"));
  EXPECT_THAT(failure({"--direct", "can:a", "--reply-timeout", "0", "axes"}).message,
              HasSubstr("within 1 to 60000"));
  EXPECT_EQ(exit_code_of(failure({"watch", "x", "--interval", "1"})), ExitCode::usage);
  EXPECT_EQ(failure({"watch", "x", "--interval", "1"}).message,
            "watch: --interval: 1 is not within 10 to 60000");
  EXPECT_EQ(failure({"--full-steps", "many", "get", "x", "4"}).message,
            "get: --full-steps: 'many' is no whole number");
  EXPECT_EQ(failure({"--unattended", "rotate", "x", "1"}).message,
            "--unattended is an option of 'rotate': write it behind that");
  EXPECT_EQ(exit_code_of(failure({"watch", "x", "--for", "-1"})), ExitCode::usage);
  EXPECT_EQ(exit_code_of(failure({"watch", "x", "--for", "nan"})), ExitCode::usage);
}

TEST(CtlOptions, HelpTeaches) {
  const auto help = information({"--help"});
  for (const auto* word : {"Examples", "Exit codes", "tmclctl move x 51200 --wait", "TMCLD_SOCKET",
                           "130", "scan", "plot", "raw"}) {
    EXPECT_THAT(help, HasSubstr(word));
  }
  EXPECT_THAT(help, testing::Not(HasSubstr("__complete")));
  EXPECT_THAT(information({"move", "--help"}), HasSubstr("Ctrl-C"));
  EXPECT_THAT(information({"--version"}), HasSubstr("tmclctl "));
}

TEST(CtlOptions, TellsTheShellItsWords) {
  EXPECT_THAT(information({"__complete", "verbs"}), HasSubstr("rotate\n"));
  EXPECT_THAT(information({"__complete", "options", "plot"}), HasSubstr("--svg\n"));
  EXPECT_THAT(information({"__complete", "parameters"}), HasSubstr("max_velocity\n"));
  EXPECT_THAT(information({"__complete", "commands"}), HasSubstr("GAP\n"));
}

TEST(CtlOptions, TheManPageKnowsEveryVerbAndOption) {
  std::ifstream in(TMCL_SOURCE_DIR "/docs/man/tmclctl.1");
  std::string page{std::istreambuf_iterator<char>(in), {}};
  std::erase(page, '\\');
  std::istringstream verbs(information({"__complete", "verbs"}));
  for (std::string verb; std::getline(verbs, verb);) {
    EXPECT_THAT(page, HasSubstr(verb + ' ')) << verb;
    std::istringstream options(information({"__complete", "options", verb}));
    for (std::string option; std::getline(options, option);) {
      EXPECT_THAT(page, HasSubstr(option)) << verb;
    }
  }
}

}  // namespace
}  // namespace tmclctl
