// New firmware for simulated modules, over real ptys and sockets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/intel_hex.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

/// On a line that takes its time, so that what is done during an upload comes during it, however
/// busy the computer is: a minute and a half for large.hex, some eight seconds for long.hex.
class TmclctlFirmware : public testing::Test, public CtlBench {
 protected:
  TmclctlFirmware() : CtlBench({"TMCM-1110", "TMCM-3110@3"}, {"--pace", "115200"}) {
    std::ofstream(file("1110.hex")) << hex_file(0x4000, firmware_bytes(3000, "1110V142"));
    std::ofstream(file("3110.hex")) << hex_file(0x4000, firmware_bytes(3000, "3110V107"));
    std::ofstream(file("long.hex")) << hex_file(0x4000, firmware_bytes(16'000, "1110V143"));
    std::ofstream(file("large.hex")) << hex_file(0x4000, firmware_bytes(200'000, "1110V143"));
  }
  std::string version(const std::string& address) {
    return run({"raw", address, "GET_FIRMWARE_VERSION", "TEXT", "0", "0"}).out;
  }
  Ran run(const Words& words) const { return ctl(direct(), words); }
};

TEST_F(TmclctlFirmware, IsUploadedOverTcpAndASerialLine) {
  const auto over_tcp = run({"firmware", "upload", file("1110.hex"), "1"});
  EXPECT_EQ(over_tcp.status, 0) << over_tcp.err;
  EXPECT_THAT(over_tcp.out, HasSubstr("module 1 runs firmware 1.42 of a TMCM-1110 now"));
  EXPECT_THAT(version("1"), HasSubstr("<- 1110V142"));
  const auto serial = ctl({"--direct", pty_link()}, {"firmware", "upload", file("3110.hex"), "3"});
  EXPECT_EQ(serial.status, 0) << serial.err;
  EXPECT_THAT(version("3"), HasSubstr("<- 3110V107"));
  EXPECT_THAT(version("1"), HasSubstr("<- 1110V142")) << "the other module is as before";
  EXPECT_EQ(run({"get", "1/0", "actual_position"}).out, "0\n");
}

TEST_F(TmclctlFirmware, IsRefusedForAnotherModel) {
  EXPECT_EQ(run({"firmware", "check", file("3110.hex"), "3"}).status, 0);
  EXPECT_EQ(run({"firmware", "check", file("3110.hex"), "1"}).status, 2);
  const auto wrong = run({"firmware", "upload", file("3110.hex"), "1"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("the image is for 3110V107; module 1 is a TMCM-1110"));
  EXPECT_THAT(version("1"), HasSubstr("<- 1110V113"));
}

TEST_F(TmclctlFirmware, AnUploadThatWasKilledIsDoneAgain) {
  {
    OnTerminal half(direct(), {"firmware", "upload", file("large.hex"), "1"});
    ASSERT_TRUE(half.wait_for("writing"));
    // The first one lets it end what a module would be useless without.
    half.press_ctrl_c();
    ASSERT_TRUE(half.wait_for("ending later"));
    half.press_ctrl_c();
    half.wait();
  }
  EXPECT_THAT(version("1"), HasSubstr("<- 1110B101"));
  const auto useless = run({"get", "1/0", "actual_position"});
  EXPECT_EQ(useless.status, 3);
  EXPECT_THAT(useless.err, HasSubstr("module 1 is in its bootloader: no firmware runs in it"));
  EXPECT_THAT(useless.err, HasSubstr("firmware upload' gives it one"));
  EXPECT_THAT(run({"scan", "--addresses", "1-3"}).out, HasSubstr("NO FIRMWARE runs"));
  const auto again = run({"firmware", "upload", file("1110.hex"), "1"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("before it was bootloader 1.01 of a TMCM-1110"));
  EXPECT_EQ(run({"get", "1/0", "actual_position"}).out, "0\n");
}

TEST_F(TmclctlFirmware, GoesThroughTheDaemonWhoseOtherClientsAreToldSo) {
  start_daemon();
  EXPECT_EQ(ctl(through_daemon(), {"firmware", "check", file("1110.hex"), "1"}).status, 0);
  EXPECT_EQ(ctl(through_daemon(), {"firmware", "check", file("1110.hex"), "3"}).status, 2);
  {
    OnTerminal upload(through_daemon(), {"firmware", "upload", file("long.hex"), "bench:1"});
    ASSERT_TRUE(upload.wait_for("writing"));
    const auto stopped = ctl(through_daemon(), {"stop", "x"});
    EXPECT_EQ(stopped.status, 3) << stopped.out;
    EXPECT_THAT(stopped.err, HasSubstr("module 1 is in its bootloader and gets new firmware"));
    EXPECT_EQ(ctl(through_daemon(), {"stop", "y"}).status, 0) << "another module";
    EXPECT_EQ(upload.wait(), 0) << upload.output();
    EXPECT_THAT(upload.output(), HasSubstr("module 1 runs firmware 1.43 of a TMCM-1110 now"));
  }
  EXPECT_EQ(ctl(through_daemon(), {"get", "x", "actual_position"}).out, "0\n");
  const auto wrong = ctl(through_daemon(), {"firmware", "upload", file("3110.hex"), "1"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("the image is for 3110V107; module 1 is a TMCM-1110"));
}

TEST_F(TmclctlFirmware, TheEndOfTheDaemonWaitsForAnUpload) {
  auto& daemon = start_daemon();
  {
    OnTerminal upload(through_daemon(), {"firmware", "upload", file("long.hex"), "bench:1"});
    ASSERT_TRUE(upload.wait_for("writing"));
    daemon.signal(SIGTERM);
    EXPECT_EQ(upload.wait(), 0) << upload.output();
    EXPECT_THAT(upload.output(), HasSubstr("module 1 runs firmware 1.43 of a TMCM-1110 now"));
  }
  EXPECT_EQ(daemon.wait(), 0);
  EXPECT_THAT(daemon.output(),
              HasSubstr("ending later, after the firmware upload to module 1 of bench"));
  EXPECT_THAT(version("1"), HasSubstr("<- 1110V143"));
}

TEST_F(TmclctlFirmware, AModuleWithoutFirmwareIsToldOfByTheDaemon) {
  {
    OnTerminal half(direct(), {"firmware", "upload", file("large.hex"), "1"});
    ASSERT_TRUE(half.wait_for("writing"));
    // The first one lets it end what a module would be useless without.
    half.press_ctrl_c();
    ASSERT_TRUE(half.wait_for("ending later"));
    half.press_ctrl_c();
    half.wait();
  }
  ASSERT_TRUE(start_daemon().wait_for("module_in_bootloader (module 1)"));
  EXPECT_THAT(ctl(through_daemon(), {"modules"}).out, HasSubstr("in_bootloader  NO FIRMWARE runs"));
  const auto scanned = ctl(through_daemon(), {"scan", "--addresses", "1-3"});
  EXPECT_THAT(scanned.out, HasSubstr("NO FIRMWARE runs, only its bootloader"));
  const auto moved = ctl(through_daemon(), {"move", "x", "100"});
  EXPECT_EQ(moved.status, 3);
  EXPECT_THAT(moved.err, HasSubstr("module 1 is in its bootloader: no firmware runs in it"));
  EXPECT_THAT(moved.err, HasSubstr("firmware upload' gives it one"));
  EXPECT_THAT(ctl(through_daemon(), {"stop", "x"}).err, HasSubstr("does not know this command"))
      << "sent, and refused by the bootloader";
  EXPECT_EQ(ctl(through_daemon(), {"stop", "y"}).status, 0) << "another module";
  const auto again = ctl(through_daemon(), {"firmware", "upload", file("1110.hex"), "1"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(ctl(through_daemon(), {"get", "x", "actual_position"}).out, "0\n");
}

}  // namespace
}  // namespace tmcl::test
