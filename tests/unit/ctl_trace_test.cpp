// trace: what tmclctl makes of what tmcld tells it of a bus.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "ctl_fixture.hpp"
#include "support/temp_path.hpp"
#include "tmcl/trace_file.hpp"

namespace tmclctl::test {
namespace {

namespace json = boost::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

class CtlTrace : public testing::Test, public Ctl {
 protected:
  ~CtlTrace() override { std::filesystem::remove(file); }

  static json::object buses(const std::vector<std::string>& names) {
    json::array all;
    for (const auto& name : names)
      all.push_back(json::object{{"name", name}, {"link", "can:can0"}, {"state", "open"}});
    return {{"buses", std::move(all)}};
  }
  static json::object datagram(int number, const char* direction, const char* bytes) {
    return {{"number", number},
            {"utc_us", 1'764'065'521'123'456},
            {"direction", direction},
            {"bytes", bytes},
            {"client", "process 4711"}};
  }
  static json::object traffic(json::array datagrams, int last, int dropped = 0) {
    return {{"bus", "bench"},
            {"last", last},
            {"dropped", dropped},
            {"datagrams", std::move(datagrams)}};
  }
  /// One exchange goes over the only bus while it is looked at.
  void let_one_exchange_pass() {
    target.results = {
        buses({"bench"}), traffic({datagram(6, "out", "01")}, 6),
        traffic({datagram(7, "out", "010601000000000008"), datagram(8, "in", "020164060000c80035")},
                8),
        traffic({}, 8)};
  }

  std::string file = tmcl::test::temp_path("trace.pcapng");
};

TEST_F(CtlTrace, ShowsWhatPassesFromNowOn) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1"}), ExitCode::done);
  EXPECT_EQ(
      out,
      "10:12:01.123456 -> 01 06 01 00 00 00 00 00 08  1 GAP actual_position 0 motor 0           "
      "process 4711\n"
      "10:12:01.123456 <- 02 01 64 06 00 00 c8 00 35  1 GAP 51200                               "
      "process 4711\n");
  EXPECT_THAT(target.calls,
              testing::Contains(R"(bus.trace {"bus":"bench","after":6,"limit":1024})"));
}

TEST_F(CtlTrace, BeginsWithWhatIsRemembered) {
  target.results = {buses({"bench"}), traffic({datagram(6, "out", "010601000000000008")}, 6),
                    traffic({}, 6)};
  EXPECT_EQ(run({"trace", "bench", "--last", "50", "--for", "0.1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("1 GAP actual_position"));
  EXPECT_THAT(target.calls, testing::Contains(R"(bus.trace {"bus":"bench","limit":50})"));
}

TEST_F(CtlTrace, IsADocumentForEachDatagram) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1", "--json"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr(R"({"utc":"2025-11-25T10:12:01.123456Z","direction":"in",)"
                             R"("bytes":"020164060000c80035","text":"1 GAP 51200",)"
                             R"("client":"process 4711"})"));
}

TEST_F(CtlTrace, AFileIsShownAsTheBusWas) {
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1", "-w", file}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(err, "2 datagrams are in " + file + "\n");
  let_one_exchange_pass();
  EXPECT_EQ(run({"trace", "--for", "1"}), ExitCode::done);
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
  auto mine = datagram(7, "out", "010601000000000008");
  mine["client"] = "tmclctl (process " + std::to_string(::getpid()) + ")";
  target.results = {buses({"bench"}), traffic({}, 6),
                    traffic({mine, datagram(8, "out", "010601000000000008")}, 8), traffic({}, 8)};
  EXPECT_EQ(run({"trace", "--for", "1", "--not-mine"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("process 4711"));
  EXPECT_THAT(out, testing::Not(HasSubstr(std::to_string(::getpid()))));
}

TEST_F(CtlTrace, SaysWhatItHasMissed) {
  target.results = {buses({"bench"}), traffic({}, 6),
                    traffic({datagram(5000, "out", "010601000000000008")}, 5000, 904),
                    traffic({}, 5000)};
  EXPECT_EQ(run({"trace", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(err, HasSubstr("904 datagrams went by too fast and are missing"));
}

TEST_F(CtlTrace, AFrameHasItsIdentifier) {
  auto frame = datagram(7, "out", "06010000000000");
  frame["can_id"] = 1;
  target.results = {buses({"bench"}), traffic({}, 6), traffic({std::move(frame)}, 7),
                    traffic({}, 7)};
  EXPECT_EQ(run({"trace", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("-> 001 06 01 00 00 00 00 00 "));
}

TEST_F(CtlTrace, EndsWithCtrlC) {
  target.results = {buses({"bench"}), traffic({}, 8)};
  host.press_ctrl_c_after(std::chrono::seconds(5));
  EXPECT_EQ(run({"trace"}), ExitCode::done);
}

TEST_F(CtlTrace, WhichBusIsAsked) {
  target.result = buses({"a", "b"});
  EXPECT_EQ(run({"trace"}), ExitCode::usage);
  EXPECT_THAT(err, AllOf(HasSubstr("which bus"), HasSubstr("It has: a, b")));
  EXPECT_EQ(run({"trace", "c"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("no bus 'c'"));
}

TEST_F(CtlTrace, FilesThatAreNoneAreNamed) {
  EXPECT_EQ(run({"trace", "--read", "/none"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("cannot read /none"));
  EXPECT_EQ(run({"trace", "bench", "--read", file}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--read takes nothing beside it"));
  target.results = {buses({"bench"}), traffic({}, 8)};
  EXPECT_EQ(run({"trace", "-w", "/none/x"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("cannot write /none/x"));
}

}  // namespace
}  // namespace tmclctl::test
