// firmware info, check and upload: files, forms and exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/intel_hex.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class CtlFirmware : public testing::Test {
 protected:
  CtlFirmware() {
    ctl.add("TMCM-1110", 7);
    std::string name = std::filesystem::temp_directory_path() / "ctl_firmware-XXXXXX";
    folder = ::mkdtemp(name.data());
    write("good.hex", tmcl::test::hex_file(0x4000, tmcl::test::firmware_bytes(100, "1110V142")));
    write("other.hex", tmcl::test::hex_file(0x4000, tmcl::test::firmware_bytes(100, "3110V142")));
    write("nameless.hex", tmcl::test::hex_file(0x4000, tmcl::test::firmware_bytes(100, "")));
    write("cut.hex", ":0400000001020304F2\n");
    write("bad.hex", ":0400000001020304F2\n:04000400010203G4F2\n");
  }
  ~CtlFirmware() override { std::filesystem::remove_all(folder); }

  std::string path(const std::string& name) const { return folder / name; }
  void write(const std::string& name, const std::string& contents) const {
    std::ofstream(path(name), std::ios::binary) << contents;
  }
  ExitCode run(const std::vector<std::string>& words) { return ctl.run(words); }
  boost::json::object json(std::vector<std::string> words, ExitCode expected = ExitCode::done) {
    return ctl.json(std::move(words), expected);
  }

  std::filesystem::path folder;
  test::CtlBench ctl;
  std::string& out = ctl.out;
  std::string& err = ctl.err;
};

TEST_F(CtlFirmware, InfoTellsWhatIsInAFile) {
  EXPECT_EQ(run({"firmware", "info", path("good.hex")}), ExitCode::done);
  EXPECT_THAT(out,
              StartsWith(path("good.hex") + ": 100 bytes, 0x00004000 to 0x00004063, checksum 0x"));
  EXPECT_THAT(out, HasSubstr("firmware 1.42 of a TMCM-1110 (1110V142)"));
  run({"firmware", "info", path("nameless.hex")});
  EXPECT_THAT(out, HasSubstr("does not say for which model it is"));
}

TEST_F(CtlFirmware, InfoAsJson) {
  const auto told = json({"firmware", "info", path("good.hex")});
  EXPECT_EQ(told.at("start"), 0x4000);
  EXPECT_EQ(told.at("bytes"), 100);
  const auto version = told.at("versions").at(0);
  EXPECT_EQ(version.at("text"), "1110V142");
  EXPECT_EQ(version.at("model"), "TMCM-1110");
  EXPECT_EQ(version.at("firmware"), "1.42");
}

TEST_F(CtlFirmware, ABadFileIsToldWithLineAndColumn) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"firmware", "info", path("bad.hex")},
        {"firmware", "check", path("bad.hex"), "7"},
        {"firmware", "upload", path("bad.hex"), "7"}}) {
    EXPECT_EQ(run(words), ExitCode::usage);
    EXPECT_THAT(err, HasSubstr(path("bad.hex") + ":2:16: 'G' is no hexadecimal digit"));
  }
  EXPECT_TRUE(ctl.calls.empty()) << "nothing was sent";
  EXPECT_EQ(run({"firmware", "info", path("cut.hex")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("seems to be cut short"));
  EXPECT_EQ(run({"firmware", "info", path("none.hex")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("cannot read " + path("none.hex")));
  const auto told = json({"firmware", "info", path("bad.hex")}, ExitCode::usage);
  EXPECT_EQ(told.at("error").at("line"), 2);
  EXPECT_EQ(told.at("error").at("name"), "bad_firmware");
}

TEST_F(CtlFirmware, CheckTellsWhetherAFileBelongsToAModule) {
  EXPECT_EQ(run({"firmware", "check", path("good.hex"), "7"}), ExitCode::done);
  EXPECT_EQ(out, "module 7 has firmware 1.13 of a TMCM-1110; " + path("good.hex") +
                     " is firmware 1.42 of a TMCM-1110\n");
  EXPECT_EQ(run({"firmware", "check", path("other.hex"), "7"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("is for 3110V142; module 7 has firmware 1.13 of a TMCM-1110"));
  EXPECT_EQ(run({"firmware", "check", path("nameless.hex"), "7"}), ExitCode::usage);
  const auto told = json({"firmware", "check", path("good.hex"), "bench:7"});
  EXPECT_EQ(told.at("module").at("offered"), "1110V142");
  EXPECT_EQ(ctl.calls.back(), R"(firmware.status {"bus":"bench","address":7})");
}

TEST_F(CtlFirmware, UploadTellsWhatRunsNow) {
  EXPECT_EQ(run({"firmware", "upload", path("good.hex"), "7"}), ExitCode::done);
  EXPECT_EQ(out,
            "module 7 runs firmware 1.42 of a TMCM-1110 now; before it was firmware 1.13 of a "
            "TMCM-1110\n");
  EXPECT_EQ(err, "");
  const auto told = json({"firmware", "upload", path("good.hex"), "7", "--force"});
  EXPECT_THAT(ctl.calls_of("firmware.upload").back(), HasSubstr(R"("force":true)"));
  EXPECT_EQ(told.at("running"), "1110V142");
  EXPECT_EQ(told.at("module").at("running"), "1110V142");
}

TEST_F(CtlFirmware, AnotherVersionThanTheFilesIsAWarning) {
  ctl.amend("firmware.upload", [](boost::json::object& told) { told["running"] = "1110V101"; });
  EXPECT_EQ(run({"firmware", "upload", path("good.hex"), "7"}), ExitCode::done);
  EXPECT_THAT(err, HasSubstr("warning"));
}

TEST_F(CtlFirmware, AFailureKeepsItsHint) {
  ctl.fail("firmware.upload", Error{"reply_timeout", ErrorKind::failed, tmcl::Outcome::unknown,
                                    "writing: no answer", "start the same upload again"});
  EXPECT_EQ(run({"firmware", "upload", path("good.hex"), "7"}), ExitCode::unknown);
  EXPECT_THAT(err, HasSubstr("writing: no answer\n  Start the same upload again"));
}

TEST_F(CtlFirmware, WhatNamesNoModuleIsRefused) {
  EXPECT_EQ(run({"firmware", "upload", path("good.hex"), "seven"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("'seven' names no module"));
  EXPECT_EQ(run({"firmware", "check", path("good.hex"), "bench:"}), ExitCode::usage);
  EXPECT_TRUE(ctl.orders().empty());
}

TEST_F(CtlFirmware, ATerminalShowsHowFarItIs) {
  write("long.hex", tmcl::test::hex_file(0x4000, tmcl::test::firmware_bytes(9000, "1110V142")));
  ctl.screen.terminal = true;
  ctl.screen.width = 80;
  run({"firmware", "upload", path("long.hex"), "7"});
  EXPECT_THAT(err, HasSubstr("writing"));
}

}  // namespace
}  // namespace tmclctl
