// tmclctl program, as a user runs it: nothing else has to run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/build_paths.hpp"
#include "support/program.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

class TmclctlProgram : public testing::Test {
 protected:
  TmclctlProgram() {
    std::string name = std::filesystem::temp_directory_path() / "tmclctl_program-XXXXXX";
    folder_ = ::mkdtemp(name.data());
  }
  ~TmclctlProgram() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& contents) const {
    std::ofstream(folder_ / name) << contents;
  }
  /// A shell's command line, in the folder; standard output and error come together.
  Finished shell(const std::string& words) const {
    return run_program(
        {"/bin/sh", "-c",
         "cd '" + folder_.string() + "' && PATH='" TMCL_BIN_DIR "':\"$PATH\" && " + words});
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(TmclctlProgram, ThereAndBackAgain) {
  write("axis.inc", "Motor0 = 0");
  write(
      "loop.tmc",
      "#include \"axis.inc\"\nLoop: MVP ABS, Motor0, -512000\n  WAIT POS, Motor0, 0\n  JA Loop\n");
  const auto ran = shell(
      "tmclctl --socket /nowhere program assemble loop.tmc -o a.bin && "
      "tmclctl program disassemble a.bin -o again.tmc && "
      "tmclctl program assemble again.tmc -o b.bin && cmp a.bin b.bin && cat again.tmc && "
      "od -An -v -tx1 -w8 a.bin");
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.output,
            "L0:\n        MVP ABS, 0, -512000\n        WAIT POS, 0, 0\n        JA L0\n"
            " 04 00 00 ff f8 30 00 2b\n 1b 01 00 00 00 00 00 1c\n 16 00 00 00 00 00 00 16\n");
}

TEST_F(TmclctlProgram, ProblemsGoToStandardErrorAndNothingElsewhere) {
  write("bad.tmc", "SAP 4, 0, 1\n  JA Nowhere\n");
  const auto ran = shell("tmclctl program assemble bad.tmc -o out.bin 2>&1 >/dev/null");
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.output, "bad.tmc:2:6: 'Nowhere' is not defined\ntmclctl: 1 problem in bad.tmc\n");
  EXPECT_EQ(shell("tmclctl program assemble bad.tmc 2>/dev/null").output, "");
  EXPECT_NE(shell("test -e out.bin").status, 0);
}

// Sources that have no end, and what has no text.
TEST_F(TmclctlProgram, BoundsWhatItReads) {
  EXPECT_THAT(shell("tmclctl program assemble /dev/zero").output,
              HasSubstr("at most 4000000 bytes"));
  EXPECT_THAT(shell("tmclctl program disassemble /dev/zero").output,
              HasSubstr("at most 2048 commands"));
  EXPECT_EQ(shell("tmclctl program assemble /dev/null").status, 0);
}

TEST_F(TmclctlProgram, BashCompletesVerbsAndOptions) {
  const auto complete = [](const std::string& words, int cursor) {
    const std::string script = "PATH='" TMCL_BIN_DIR "':$PATH; source '" TMCL_SOURCE_DIR
                               "/config/completions/tmclctl.bash'; compopt() { echo \"$*\"; }; "
                               "COMP_WORDS=(" +
                               words + "); COMP_CWORD=" + std::to_string(cursor) +
                               "; _tmclctl; echo \"${COMPREPLY[*]}\"";
    return run_program({"/bin/bash", "-c", script}).output;
  };
  EXPECT_EQ(complete("tmclctl prog", 1), "program\n");
  EXPECT_THAT(complete("tmclctl program ''", 2),
              testing::StartsWith("assemble disassemble upload "));
  EXPECT_EQ(complete("tmclctl program assemble --l", 3), "--listing\n");
  EXPECT_EQ(complete("tmclctl program assemble ''", 3), "-o default\n\n") << "a file";
  EXPECT_EQ(complete("tmclctl program assemble -o ''", 4), "-o default\n\n") << "a file";
  EXPECT_EQ(complete("tmclctl program assemble -o a.bin ''", 5), "-o default\n\n") << "a file";
}

}  // namespace
}  // namespace tmcl::test
