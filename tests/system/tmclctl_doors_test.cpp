// Every verb that goes through both doors does the same through both: with --direct, and with a
// tmcld that names no axis.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>

#include "command_line/verb_info.hpp"
#include "support/intel_hex.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

/// The shell's way of writing a command line.
Words words_of(const std::string& line) {
  Words words;
  std::istringstream in(line);
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// In an order in which each finds what it needs. FOLDER is the bench's.
const std::vector<std::string> lines{
    "scan --addresses 1-3",
    "get 1/0 max_velocity",
    "set 1/0 max_velocity 1500",
    "set 1/0 max_velocity 99999",
    "get 1/0 max_velocty",
    "store 1/0 max_velocity",
    "restore 1/0 max_velocity",
    "store 1/0 target_position",
    "params 3/1 --values",
    "call axis.get_units {\"axis\":\"3/1\"}",
    "call axis.got {\"axis\":\"3/1\"}",
    "ramp 3/1 --velocity 100000pps --acceleration 1000000pps/s",
    "ramp 3/1 --time 500ms --distance 20000",
    "resonance 3/1 --distance 500 --for 0.1",
    "tune 3/1 --max-current 100 --travel 0..100 --yes",
    "move 1/0 5000 --wait",
    "move 1/0 1rev --by --wait",
    "move 1/0 1mm",
    "wait 1/0",
    "line 3/0=4000 3/1=2000 --wait",
    "state 1/0",
    "watch 1/0 --for 0.2",
    "watch 1/0 --also max_current --for 0.2",
    "watch 1/0 --also max_curent --for 0.2",
    "top",
    "errors 1/0",
    "scan-positions 1/0 --from 0 --to 400 --steps 3 --both-ways --csv FOLDER/scan.csv",
    "scan-positions 1/0 --from 0 --to 400 --steps 3 --both-ways --csv FOLDER/scan.csv",
    "scan-positions 1/0 --from 0 --to 400 --steps 3 --both-ways --csv FOLDER/scan.csv --resume",
    "scan-positions 1/0 --from 0 --to 1mm --steps 3",
    "jog 1/0",
    "recover 1/0",
    "capture 1/0 --channel actual_position",
    "capture 1/0 --channel actual_positon",
    "deadman set 1/0 600",
    "deadman off 1/0",
    "rotate 3/2 500 --unattended",
    "stop 3/2",
    "home 1/0 --mode 137",
    "home 1/0 --stop",
    "coordinate set 1/0 3 500",
    "coordinate get 1/0 3",
    "coordinate capture 1/0 4",
    "coordinate move 1/0 3",
    "wait 1/0",
    "coordinate start 3 0 1 2",
    "coordinate store 3/0",
    "coordinate load 3/0",
    "arrivals 1 --off",
    "global get 1 66",
    "global set 1 5 -7 --bank 2",
    "global store 1 5 --bank 2",
    "global restore 1 5 --bank 2",
    "input 1 0",
    "output 1 0 1",
    "output 1 0",
    "info 1",
    "info 9",
    "raw 1 GAP max_velocity 0 0",
    "program upload FOLDER/stop.tmc 1",
    "program verify FOLDER/stop.tmc 1",
    "program download 1",
    "program breakpoint 1 1",
    "program clear-breakpoint 1 1",
    "program clear-breakpoints 1",
    "program run 1",
    "program step 1",
    "program status 1",
    "program stop 1",
    "program reset 1",
    "program debug FOLDER/stop.tmc 1",
    "firmware check FOLDER/firmware.hex 1",
    "firmware upload FOLDER/firmware.hex 3",
    "mint run FOLDER/go.mint --axis 0=1/0",
    "reset 1",
    "factory-reset 1 --yes",
};
/// What these print is the door's own, or measured: they only end well.
const std::vector<std::string> lists{
    "modules",
    "axes",
    "buses --for 0.1",
    "state 1/0",
    "settings show 1",
    "settings save 1 -o FOLDER/a.toml",
    "settings diff FOLDER/a.toml 1",
    "settings load FOLDER/a.toml 1",
    "path run FOLDER/path.csv --axis x=3/0 --axis y=3/1 --per-turn 5 --dry-run",
    "recover 1/0",
    "deadman set 1/0 500",
    "deadman test 1/0",
    "deadman off 1/0",
    "verify 1/0 --travel 0..1 --yes",
    "stop --all",
    "plot 1/0 --for 0.1 --csv FOLDER/plot.csv",
    "plot 1/0 3/0 --also load_value --for 0.1 --csv FOLDER/plots.csv"};

/// What it finds is that of a door that has seen modules start again, or has not.
constexpr auto finds_faults = "doctor 1/0";

/// What is measured, and what the bus and the door are called, is not the same twice.
std::string without_what_differs(std::string text) {
  for (const auto* other : {R"( --(direct|socket) \S+)", R"(\d+\.\d+ (s|ms)\b)", "bench|direct",
                            R"(smart_energy_actual_current \d+)", " +"})
    text = std::regex_replace(text, std::regex(other), " ");
  return text;
}

class TmclctlDoors : public testing::Test {
 protected:
  static void write_files(const CtlBench& bench) {
    std::ofstream(bench.file("stop.tmc")) << "WAIT TICKS, 0, 100000\nSTOP\n";
    std::ofstream(bench.file("go.mint")) << "SPEED = 1000\nACCEL = 10000\nMOVER = 200\nGO\n";
    std::ofstream(bench.file("path.csv")) << "x,y\n0,0\n1,1\n";
    std::ofstream(bench.file("firmware.hex")) << hex_file(0x4000, firmware_bytes(100, "3110V142"));
  }
  static Words on(const CtlBench& bench, const std::string& line) {
    return words_of(std::regex_replace(line, std::regex("FOLDER/"), bench.file("")));
  }
  static std::string told(const CtlBench& bench, const Ran& ran) {
    return std::regex_replace(without_what_differs(ran.out + ran.err), std::regex(bench.file("")),
                              "");
  }
};

TEST_F(TmclctlDoors, EveryVerbDoesTheSameThroughBoth) {
  CtlBench direct;
  CtlBench daemon;
  write_files(direct);
  write_files(daemon);
  daemon.start_daemon_without_axes();
  for (const auto& line : lines) {
    SCOPED_TRACE(line);
    const auto by_direct = direct.ctl(direct.direct(), on(direct, line));
    const auto by_daemon = daemon.ctl(daemon.through_daemon(), on(daemon, line));
    EXPECT_EQ(by_direct.status, by_daemon.status) << by_direct.err << by_daemon.err;
    EXPECT_EQ(told(direct, by_direct), told(daemon, by_daemon));
  }
  EXPECT_LE(direct.ctl(direct.direct(), on(direct, finds_faults)).status, 1);
  EXPECT_LE(daemon.ctl(daemon.through_daemon(), on(daemon, finds_faults)).status, 1);
  for (const auto& line : lists) {
    EXPECT_EQ(direct.ctl(direct.direct(), on(direct, line)).status, 0) << line;
    EXPECT_EQ(daemon.ctl(daemon.through_daemon(), on(daemon, line)).status, 0) << line;
  }
}

TEST_F(TmclctlDoors, TheListHasEveryVerbThatGoesThroughBoth) {
  for (const auto& verb : tmclctl::verb_table()) {
    if (verb.doors != tmclctl::Doors::both) continue;
    const auto is_called = [&](const std::string& line) {
      return (line + ' ').starts_with(std::string(verb.name) + ' ');
    };
    EXPECT_TRUE(std::ranges::any_of(lines, is_called) || std::ranges::any_of(lists, is_called) ||
                is_called(finds_faults))
        << verb.name;
  }
}

TEST_F(TmclctlDoors, ALineIsWatchedToItsEndAndThenHasItsSettingsBack) {
  CtlBench bench;
  const auto before = bench.ctl(bench.direct(), {"get", "3/1", "max_velocity"}).out;
  const auto line = bench.ctl(bench.direct(), {"line", "3/0=20000", "3/1=5000"});
  EXPECT_EQ(line.status, 0) << line.err;
  EXPECT_THAT(line.err, HasSubstr("watching the axes until they stand"));
  EXPECT_EQ(bench.ctl(bench.direct(), {"get", "3/1", "actual_position"}).out, "5000\n");
  EXPECT_EQ(bench.ctl(bench.direct(), {"get", "3/1", "max_velocity"}).out, before);
}

TEST_F(TmclctlDoors, CtrlCStopsALineThatNobodyElseWatches) {
  CtlBench bench;
  for (const bool waits : {false, true}) {
    Words words{"line", "3/0=1000000", "3/1=500000"};
    if (waits) words.emplace_back("--wait");
    OnTerminal program(bench.direct(), words);
    ASSERT_TRUE(program.wait_for(waits ? " s left" : "watching"));
    program.press_ctrl_c();
    EXPECT_EQ(program.wait(), 130);
    EXPECT_THAT(program.output(), HasSubstr("the axes were stopped on their way"));
    EXPECT_EQ(bench.json(bench.direct(), {"state", "3/0"}).at("moving"), false);
  }
}

TEST_F(TmclctlDoors, AConfigurationNamesTheAxesOfALink) {
  CtlBench bench;
  std::ofstream(bench.file("axes.toml"))
      << "[[bus]]\nname = \"bench\"\nlink = \"can:can7\"\n[[axis]]\nname = \"x\"\nbus = \"bench\"\n"
         "address = 1\nmotor = 0\nunit = \"mm\"\nunits_per_revolution = 5\nsoft_limits = [0, 10]\n";
  auto how = bench.direct();
  how.insert(how.end(), {"--config", bench.file("axes.toml")});
  EXPECT_EQ(bench.ctl(how, {"move", "x", "2.5mm", "--wait"}).out, "x stands at 2.5 mm\n");
  EXPECT_EQ(bench.ctl(how, {"move", "1/0", "20mm"}).status, 1) << "a limit of the motor";
  EXPECT_THAT(bench.ctl(how, {"axes"}).out, HasSubstr("mm"));
  std::ofstream(bench.file("axes.toml"), std::ios::app)
      << "[[bus]]\nname = \"other\"\nlink = \"can:can8\"\n";
  const auto which = bench.ctl(how, {"state", "x"});
  EXPECT_EQ(which.status, 2);
  EXPECT_THAT(which.err, HasSubstr("other"));
}

}  // namespace
}  // namespace tmcl::test
