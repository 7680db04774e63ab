// tmclctl trace: what goes over a bus of a real tmcld, in files that Wireshark and tmclsim read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class TmclctlTrace : public testing::Test, public CtlBench {
 protected:
  TmclctlTrace() : CtlBench({"TMCM-1110"}) { start_daemon(); }
  Ran run(const Words& words) const { return ctl(through_daemon(), words); }
  /// Of a client of its own, beside that of the trace.
  void record_a_move() {
    Program tracing({"tmclctl", "--socket", file("tmcld.sock"), "trace", "-w", file("x.pcapng")});
    for (int i = 0; i < 100 && !std::filesystem::exists(file("x.pcapng")); ++i) ::usleep(50'000);
    ASSERT_EQ(run({"move", "x", "2000", "--wait"}).status, 0);
    tracing.signal(SIGINT);
    ASSERT_EQ(tracing.wait(), 0) << tracing.output();
    EXPECT_THAT(tracing.output(), ContainsRegex("[0-9]+ datagrams are in "));
  }
};

TEST_F(TmclctlTrace, SaysWhoAsked) {
  ASSERT_EQ(run({"move", "x", "2000", "--wait"}).status, 0);
  const auto ran = run({"trace", "bench", "--last", "1000", "--for", "0.1"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out,
              ContainsRegex("-> 01 04 00 00 00 00 07 d0 dc  1 MVP ABS 2000 motor 0 +process"));
  EXPECT_THAT(ran.out, ContainsRegex("<- 02 01 64 04 00 00 07 d0 42  1 MVP 2000 +process [0-9]+"));
}

TEST_F(TmclctlTrace, AFileIsReadHereAndByWireshark) {
  record_a_move();
  const auto shown = ctl({}, {"trace", "--read", file("x.pcapng")});
  EXPECT_EQ(shown.status, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("1 MVP ABS 2000 motor 0"));
  const auto dissected =
      run_program({"/bin/sh", "-c",
                   "tshark -X lua_script:" TMCL_SOURCE_DIR "/config/wireshark/tmcl.lua -r '" +
                       file("x.pcapng") + "' 2>&1"});
  EXPECT_EQ(dissected.status, 0) << dissected.output;
  EXPECT_THAT(dissected.output, ContainsRegex("TMCL .*1 MVP 0 2000 motor 0"));
  EXPECT_THAT(dissected.output, ContainsRegex("TMCL .*1 MVP ok 2000"));
  EXPECT_THAT(dissected.output, Not(HasSubstr("Lua Error")));
}

TEST_F(TmclctlTrace, WhatARecordHasAskedAVirtualModuleIsAskedAgain) {
  record_a_move();
  const auto again =
      run_program({"tmclsim", "--module", "TMCM-1110", "--replay", file("x.pcapng")});
  EXPECT_THAT(again.output, ContainsRegex("[0-9]+ requests: [0-9]+ replies as recorded"));
  EXPECT_THAT(again.output, Not(HasSubstr("otherwise different")));
  EXPECT_THAT(again.output, Not(HasSubstr("missing")));
  const auto none = run_program({"tmclsim", "--module", "TMCM-1110", "--replay", file("none")});
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.output, HasSubstr("cannot read " + file("none")));
}

}  // namespace
}  // namespace tmcl::test
