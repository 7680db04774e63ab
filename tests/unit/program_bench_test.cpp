// A program on a simulated module, forwards and back in virtual time.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "support/program_host.hpp"
#include "support/temp_path.hpp"
#include "tools/tmclsim/program_debug.hpp"

namespace tmclsim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using tmcl::program::Standing;
using tmcl::program::Watched;

constexpr const char* text =
    "        CALCV LOAD, 3, 2\n"  // 0
    "Loop:   MVP REL, 0, 512\n"   // 1
    "        WAIT POS, 0, 0\n"    // 2
    "        CSUB Count\n"        // 3
    "        JC NZ, Loop\n"       // 4
    "        STOP\n"              // 5
    "Count:  CALCV SUB, 3, 1\n"   // 6
    "        GGP 3, 2\n"          // 7
    "        RSUB\n";             // 8

void build(tmcl::sim::Bench& bench) {
  bench.add(*tmcl::find_model("TMCM-1110"), tmcl::ModuleAddress{1});
}

ProgramBench program_bench() { return {build, tmcl::sim::assembled(text)}; }

std::string all_of(const Standing& now) {
  std::string all = now.state + ' ' + std::to_string(*now.address) + ' ' +
                    std::to_string(*now.last_error) + ' ' + std::to_string(*now.time_s) + ' ' +
                    std::to_string(now.registers->accumulator) + (now.registers->zero ? " z" : "");
  for (const auto address : now.registers->returns) all += ' ' + std::to_string(address);
  return all;
}

TEST(ProgramBench, GoesCommandByCommand) {
  auto bench = program_bench();
  EXPECT_EQ(bench.look().address, 0);
  EXPECT_EQ(bench.step(1, {}).address, 1);
  EXPECT_EQ(bench.step(2, {}).address, 3);
  EXPECT_EQ(bench.read(Watched{0, "actual_position"}), 512);
  const auto inside = bench.step(1, {});
  EXPECT_EQ(inside.address, 6);
  EXPECT_THAT(inside.registers->returns, ElementsAre(4));
  EXPECT_EQ(bench.step(2, {}).registers->accumulator, 1);
  EXPECT_EQ(bench.read(Watched{{}, "3"}), 1);
}

TEST(ProgramBench, StandsBeforeABreakpointAndAtTheEnd) {
  auto bench = program_bench();
  const std::vector<std::uint16_t> breakpoints{6};
  auto now = bench.step(1000, breakpoints);
  EXPECT_EQ(now.reason, "breakpoint");
  EXPECT_EQ(now.steps, 4U);
  now = bench.step(1000, breakpoints);
  EXPECT_EQ(now.steps, 7U);
  EXPECT_EQ(now.address, 6);
  now = bench.step(1000, breakpoints);
  EXPECT_EQ(now.reason, "ended");
  EXPECT_EQ(now.state, "stopped");
  EXPECT_EQ(bench.read(Watched{0, "actual_position"}), 1024);
}

TEST(ProgramBench, BackIsWhereItStood) {
  auto bench = program_bench();
  std::vector<std::string> stood{all_of(bench.look())};
  std::vector<std::int32_t> positions{0};
  for (int i = 0; i < 14; ++i) {
    stood.push_back(all_of(bench.step(1, {})));
    positions.push_back(bench.read(Watched{0, "actual_position"}).value());
  }
  for (std::size_t i = 14; i-- > 0;) {
    EXPECT_EQ(all_of(bench.back(1)), stood[i]) << i;
    EXPECT_EQ(bench.read(Watched{0, "actual_position"}), positions[i]);
  }
  EXPECT_EQ(bench.back(5).address, 0) << "not before the start";
  // And forwards again, the same way.
  EXPECT_EQ(all_of(bench.step(14, {})), stood.back());
  EXPECT_EQ(all_of(bench.back(6)), stood[8]);
}

TEST(ProgramBench, TakesAsLongAsARun) {
  auto bench = program_bench();
  const auto stepped = bench.step(1000, {});
  // The same program, run by itself.
  tmcl::VirtualClock clock;
  tmcl::sim::Bench running(clock);
  build(running);
  auto& module = *running.modules().front();
  struct NoEvents final : tmcl::sim::EventSink {
    void target_reached(const tmcl::sim::Module&, std::int32_t) override {}
  } events;
  const auto ask = [&](tmcl::Command command, std::uint8_t type, std::uint8_t motor,
                       std::int32_t value) {
    const tmcl::Request request{tmcl::ModuleAddress{1}, command, type, motor, value};
    module.execute(request, tmcl::sim::Medium::serial, events);
  };
  ask(tmcl::Command::START_DOWNLOAD, 0, 0, 0);
  for (const auto& line : tmcl::sim::assembled(text))
    ask(line.command, line.type, line.motor, line.value);
  ask(tmcl::Command::END_DOWNLOAD, 0, 0, 0);
  ask(tmcl::Command::RUN_APPLICATION, 1, 0, 0);
  while (module.program_inside().is_busy) {
    clock.advance_to(std::max(clock.now(), running.next_due()));
    running.run_due();
  }
  const auto ran = std::chrono::duration<double>(clock.now() - tmcl::TimePoint{}).count();
  // The last command takes its time, too.
  EXPECT_NEAR(*stepped.time_s, ran, 0.000'101);
}

TEST(ProgramBench, AWaitForWhatNeverComesIsTold) {
  ProgramBench bench(build, tmcl::sim::assembled("ROR 0, 100\n WAIT RFS, 0, 0\n WAIT REFSW, 0, 0"));
  EXPECT_EQ(bench.step(2, {}).reason, "steps");
  const auto now = bench.step(1, {});
  EXPECT_EQ(now.reason, "waits");
  EXPECT_EQ(now.address, 2);
  EXPECT_GE(*now.time_s, 3600);
  EXPECT_EQ(bench.stop().state, "stopped");
}

TEST(ProgramBench, SaysWhatTheModuleDoesNotTell) {
  auto bench = program_bench();
  EXPECT_EQ(bench.read(Watched{0, "colour"}).error(),
            "there is no parameter 'colour' of a TMCM-1110");
  EXPECT_THAT(bench.read(Watched{0, "255"}).error(), StartsWith("the module refuses to tell it"));
}

std::string debugged(const std::string& source, const std::string& lines) {
  const auto path = tmcl::test::temp_path("debugged.tmc");
  std::ofstream(path) << source;
  std::istringstream in(lines);
  std::ostringstream out;
  const auto status =
      debug_program(path, *tmcl::find_model("TMCM-1110"), build, in, out, out, false);
  return out.str() + (status == 0 ? "" : "exit " + std::to_string(status));
}

TEST(ProgramDebugging, LinesAreCarriedOut) {
  const auto output =
      debugged(text, "break Count\ncontinue\nstep\n\nback\nregisters\nquit\nstep\n");
  EXPECT_THAT(output, StartsWith("0.0000 s       0"));
  EXPECT_THAT(output, HasSubstr("breakpoint Count after 4 commands\n"));
  EXPECT_THAT(output, HasSubstr("      stack: none -> Loop+3\n"));
  EXPECT_THAT(output, HasSubstr("      accumulator: 0 -> 1\n"));
  EXPECT_THAT(output, HasSubstr("      accumulator: 1 -> 0\n")) << "back";
  EXPECT_THAT(output, HasSubstr("      accumulator  0\n"));
}

TEST(ProgramDebugging, ProblemsOfTheTextAreToldByLine) {
  EXPECT_THAT(
      debugged("MVPP ABS, 0, 1\n", ""),
      HasSubstr("debugged.tmc:1:1: there is no command 'MVPP'. Did you mean 'MVP'?\nexit 1"));
}

}  // namespace
}  // namespace tmclsim
