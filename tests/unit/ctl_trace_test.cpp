// trace: what tmclctl makes of what tmcld tells it of a bus.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "sim/module/module.hpp"
#include "support/temp_path.hpp"
#include "tmcl/trace_file.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;

class CtlTrace : public testing::Test, public CtlBench {
 protected:
  explicit CtlTrace(const std::string& toml = plain_axis) : CtlBench(toml) {
    place(51'200);
    run({"state", "x"});
    pass(std::chrono::seconds(2));
    calls.clear();
  }
  ~CtlTrace() override { std::filesystem::remove(file); }

  /// One goes over the only bus while it is looked at.
  void let_one_exchange_pass() {
    other_after(std::chrono::milliseconds(500), "module.execute",
                {{"bus", "bench"},
                 {"address", 1},
                 {"command", 6},
                 {"type", 1},
                 {"motor", 0},
                 {"value", 0}});
  }

  std::string file = tmcl::test::temp_path("trace.pcapng");
};

struct CtlTraceOfCan : CtlTrace {
  CtlTraceOfCan()
      : CtlTrace("[[bus]]\nname = \"bench\"\nlink = \"can:none\"\n" + axis_section("x", 1)) {}
};
struct CtlTraceOfTwoBuses : CtlTrace {
  CtlTraceOfTwoBuses()
      : CtlTrace(plain_axis + "[[bus]]\nname = \"other\"\nlink = \"can:none\"\n") {}
};

TEST_F(CtlTrace, ShowsWhatPassesFromNowOn) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(
      out,
      MatchesRegex(
          "01:00:[0-9.]+ -> 01 06 01 00 00 00 00 00 08  1 GAP actual_position 0 motor 0 +other\n"
          "01:00:[0-9.]+ <- 02 01 64 06 00 00 c8 00 35  1 GAP 51200 +other\n"));
  EXPECT_THAT(calls_of("bus.trace").at(1),
              MatchesRegex(R"(bus.trace ."bus":"bench","after":[0-9]+,"limit":1024.)"));
}

TEST_F(CtlTrace, BeginsWithWhatIsRemembered) {
  EXPECT_EQ(run({"trace", "bench", "--last", "50", "--for", "0.1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("1 GAP actual_position"));
  EXPECT_THAT(calls, testing::Contains(R"(bus.trace {"bus":"bench","limit":50})"));
}

TEST_F(CtlTrace, IsADocumentForEachDatagram) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1", "--json"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr(R"({"utc":"1970-01-01T01:00:)"));
  EXPECT_THAT(out, HasSubstr(R"(Z","direction":"in",)"
                             R"("bytes":"020164060000c80035","text":"1 GAP 51200",)"
                             R"("client":"other"})"));
}

TEST_F(CtlTrace, AFileIsShownAsTheBusWas) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1", "-w", file}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(err, "2 datagrams are in " + file + "\n");
  EXPECT_EQ(run({"trace", "--last", "2", "--for", "0.1"}), ExitCode::done);
  const auto shown = out;
  EXPECT_EQ(run({"trace", "--read", file}), ExitCode::done);
  EXPECT_EQ(out, shown);
  EXPECT_EQ(tmcl::read_trace_file(file).value().bus, "bench");
}

TEST_F(CtlTrace, OnStandardOutputThereIsNothingButTheFile) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1", "-w", "-"}), ExitCode::done);
  EXPECT_EQ(tmcl::parse_trace_file(out).value().datagrams.size(), 2U);
}

TEST_F(CtlTrace, ShowsOnlyTheCommandsThatAreWanted) {
  for (const auto* commands : {"GAP", "gap,MVP"}) {
    let_one_exchange_pass();
    EXPECT_EQ(run({"trace", "--for", "1", "--only", commands}), ExitCode::done);
    EXPECT_THAT(out, HasSubstr("1 GAP actual_position"));
    EXPECT_THAT(out, HasSubstr("1 GAP 51200")) << "the answer to it";
  }
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1", "--only", "MVP,MST"}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(run({"trace", "--only", "MPV"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("there is no command 'MPV'"));
}

TEST_F(CtlTrace, LeavesOutWhatThisTerminalHasAsked) {
  run({"get", "x", "max_velocity"});
  other(
      "module.execute",
      {{"bus", "bench"}, {"address", 1}, {"command", 6}, {"type", 1}, {"motor", 0}, {"value", 0}});
  EXPECT_EQ(run({"trace", "--last", "4", "--for", "0.1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr(std::to_string(::getpid())));
  EXPECT_EQ(run({"trace", "--last", "4", "--for", "0.1", "--not-mine"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("other"));
  EXPECT_THAT(out, testing::Not(HasSubstr(std::to_string(::getpid()))));
}

TEST_F(CtlTrace, SaysWhatItHasMissed) {
  let_one_exchange_pass();
  amend("bus.trace", [](boost::json::object& told) {
    if (!told.at("datagrams").as_array().empty()) told["dropped"] = 904;
  });
  EXPECT_EQ(run({"trace", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(err, HasSubstr("904 datagrams went by too fast and are missing"));
}

TEST_F(CtlTraceOfCan, HasTheIdentifierOfAFrame) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("-> 001 06 01 00 00 00 00 00 "));
}

TEST_F(CtlTrace, EndsWithCtrlC) {
  host.press_ctrl_c_after(std::chrono::seconds(5));
  EXPECT_EQ(run({"trace"}), ExitCode::done);
}

TEST_F(CtlTraceOfTwoBuses, WhichOneIsAsked) {
  EXPECT_EQ(run({"trace"}), ExitCode::usage);
  EXPECT_THAT(err, AllOf(HasSubstr("which bus"), HasSubstr("It has: bench, other")));
  EXPECT_EQ(run({"trace", "c"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("no bus 'c'"));
}

TEST_F(CtlTrace, FilesThatAreNoneAreNamed) {
  EXPECT_EQ(run({"trace", "--read", "/none"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("cannot read /none"));
  EXPECT_EQ(run({"trace", "bench", "--read", file}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--read takes nothing beside it"));
  EXPECT_EQ(run({"trace", "-w", "/none/x"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("cannot write /none/x"));
}

}  // namespace
}  // namespace tmclctl::test
