// program assemble and disassemble: files, forms and exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "command_line/options.hpp"
#include "support/build_paths.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;

const std::string loop_text = "Loop: MVP ABS, 0, Far\n  JA Loop\n";
const std::string loop_bytes("\x04\0\0\0\0\0\x05\x09\x16\0\0\0\0\0\0\x16", 16);

/// In a folder of its own, with a program.
class CtlProgram : public testing::Test, public test::CtlBench {
 protected:
  CtlProgram() {
    std::string name = std::filesystem::temp_directory_path() / "ctl_program-XXXXXX";
    folder = ::mkdtemp(name.data());
    write("loop.tmc", "#include far.tmc\n" + loop_text);
    write("far.tmc", "Far = 5");
    write("bad.tmc", "#include worse.tmc\n  MVPP ABS, 0, 1\n");
    write("worse.tmc", "COMP 1 +");
    write("loop.bin", loop_bytes);
  }
  ~CtlProgram() override { std::filesystem::remove_all(folder); }

  std::string path(const std::string& name) const { return folder / name; }
  void write(const std::string& name, const std::string& contents) const {
    std::ofstream(path(name), std::ios::binary) << contents;
  }
  std::string contents(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  ExitCode assemble(const std::string& name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"program", "assemble", path(name)};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  ExitCode disassemble(const std::string& name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"program", "disassemble", path(name)};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }

  std::filesystem::path folder;
};

const std::string loop_listing =
    "                                  1  #include far.tmc\n"
    "                                  1  Far = 5\n"
    "   0  04 00 00 00 00 00 05 09     2  Loop: MVP ABS, 0, Far\n"
    "   1  16 00 00 00 00 00 00 16     3    JA Loop\n";

TEST_F(CtlProgram, PrintsTheListingOrWritesTheFileOrBoth) {
  EXPECT_EQ(assemble("loop.tmc"), ExitCode::done);
  EXPECT_EQ(out, loop_listing);
  EXPECT_EQ(assemble("loop.tmc", {"-o", path("a.bin")}), ExitCode::done);
  EXPECT_EQ(out + err, "");
  EXPECT_EQ(contents("a.bin"), loop_bytes);
  EXPECT_EQ(assemble("loop.tmc", {"--listing", "--output", path("b.bin")}), ExitCode::done);
  EXPECT_EQ(out, loop_listing);
  EXPECT_EQ(contents("b.bin"), loop_bytes);
}

TEST_F(CtlProgram, TellsEveryProblemAndWritesNothing) {
  write("out.bin", "precious");
  EXPECT_EQ(assemble("bad.tmc", {"-o", path("out.bin"), "--listing"}), ExitCode::usage);
  EXPECT_EQ(out, "");
  EXPECT_EQ(err, path("worse.tmc") + ":1:9: a value is missing\n" + path("bad.tmc") +
                     ":2:3: there is no command 'MVPP'. Did you mean 'MVP'?\n"
                     "tmclctl: 2 problems in " +
                     path("bad.tmc") + '\n');
  EXPECT_EQ(contents("out.bin"), "precious");
}

TEST_F(CtlProgram, SaysWhenThereMayBeMoreProblems) {
  std::string text;
  for (int i = 0; i < 200; ++i) text += "NOPE\n";
  write("many.tmc", text);
  EXPECT_EQ(assemble("many.tmc"), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("tmclctl: at least 100 problems in "));
}

TEST_F(CtlProgram, FilesThatCannotBeReadOrWritten) {
  EXPECT_EQ(assemble("gone.tmc"), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(path("gone.tmc") + ": cannot be read: No such file or directory\n"));
  EXPECT_EQ(assemble(""), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("Is a directory"));
  EXPECT_EQ(assemble("loop.tmc", {"-o", path("no/such/folder")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("cannot write"));
  EXPECT_EQ(disassemble("gone.bin"), ExitCode::usage);
  EXPECT_EQ(err, "tmclctl: cannot read " + path("gone.bin") + ": No such file or directory\n");
}

TEST_F(CtlProgram, DoesNotWriteOverWhatItReads) {
  const auto before = contents("far.tmc");
  EXPECT_EQ(assemble("loop.tmc", {"-o", path("far.tmc")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("far.tmc is read; it is not written over"));
  EXPECT_EQ(contents("far.tmc"), before);
  EXPECT_EQ(disassemble("loop.bin", {"-o", path("./loop.bin")}), ExitCode::usage);
  EXPECT_EQ(contents("loop.bin"), loop_bytes);
}

TEST_F(CtlProgram, DisassemblesToTheScreenOrAFile) {
  const std::string text = "L0:\n        MVP ABS, 0, 5\n        JA L0\n";
  EXPECT_EQ(disassemble("loop.bin"), ExitCode::done);
  EXPECT_EQ(out, text);
  EXPECT_EQ(disassemble("loop.bin", {"-o", path("again.tmc")}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(contents("again.tmc"), text);
  EXPECT_EQ(assemble("again.tmc", {"-o", path("again.bin")}), ExitCode::done);
  EXPECT_EQ(contents("again.bin"), loop_bytes);
}

TEST_F(CtlProgram, SaysWhatIsNoProgramFile) {
  EXPECT_EQ(disassemble("loop.tmc"), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("loop.tmc: a program has eight bytes for each command"));
  write("long.bin", std::string(100'000, '\0'));
  EXPECT_EQ(disassemble("long.bin"), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("at most 2048 commands"));
  write("damaged.bin", std::string(8, '\1'));
  EXPECT_EQ(disassemble("damaged.bin"), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("the sum of command 0 is 1 and should be 7"));
}

TEST_F(CtlProgram, Json) {
  const auto document = json({"program", "assemble", path("loop.tmc"), "-o", path("a.bin")});
  EXPECT_EQ(contents("a.bin"), loop_bytes);
  EXPECT_EQ(document.at("file").as_string(), path("loop.tmc"));
  EXPECT_EQ(boost::json::serialize(document.at("labels")), R"([{"name":"Loop","address":0}])");
  EXPECT_EQ(boost::json::serialize(document.at("program").as_array().at(0)),
            R"({"address":0,"command":4,"type":0,"motor":0,"value":5,"file":)" +
                boost::json::serialize(boost::json::string(path("loop.tmc"))) + R"(,"line":2})");
  EXPECT_EQ(json({"program", "disassemble", path("loop.bin")}).at("commands"), 2);

  const auto error = json({"program", "assemble", path("bad.tmc")}, ExitCode::usage).at("error");
  EXPECT_EQ(err, "");
  EXPECT_EQ(error.at("name"), "bad_program");
  const auto& problems = error.at("problems").as_array();
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[1].at("file").as_string(), path("bad.tmc"));
  EXPECT_EQ(problems[1].at("line"), 2);
  EXPECT_EQ(problems[1].at("column"), 3);
  EXPECT_EQ(problems[1].at("word"), "MVPP");
}

std::string information(const std::vector<std::string>& words) {
  return std::get<Information>(parse_options(words).value()).text;
}

TEST_F(CtlProgram, IsAGroupOfVerbs) {
  EXPECT_EQ(run({"program"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("a verb is missing: assemble, disassemble"));
  EXPECT_EQ(run({"program", "asemble"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("Did you mean 'assemble'?"));
  EXPECT_EQ(run({"program", "assemble"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("FILE"));
  EXPECT_THAT(information({"__complete", "verbs", "program"}),
              testing::StartsWith("assemble\ndisassemble\nupload\n"));
}

/// What stands indented between "FILE is" and the next paragraph.
std::string program_in(const std::string& help) {
  const auto begin = help.find("\n\n", help.find("TMCL-IDE:")) + 2;
  return help.substr(begin, help.find("\n\n", begin) - begin);
}

TEST_F(CtlProgram, TheExampleOfTheHelpWorks) {
  write("speeds.tmc", "");
  write("help.tmc", program_in(information({"program", "assemble", "--help"})));
  EXPECT_EQ(assemble("help.tmc"), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("3  FA 01 02 00 00 00 03 00"));
}

TEST_F(CtlProgram, AModelSaysWhichParameterANameIs) {
  write("mode.tmc", "#include TMCLParam.tmc\nSAP ramp_mode, 0, 2\n");
  EXPECT_EQ(assemble("mode.tmc"), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("name the model of the module"));
  EXPECT_EQ(assemble("mode.tmc", {"--model", "TMCM-1110"}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("05 8A 00"));
  EXPECT_EQ(assemble("mode.tmc", {"--model", "TMCM-1"}), ExitCode::usage);
}

TEST_F(CtlProgram, TheManPageKnowsEveryOption) {
  std::ifstream in(TMCL_SOURCE_DIR "/docs/man/tmclctl.1");
  std::string page{std::istreambuf_iterator<char>(in), {}};
  std::erase(page, '\\');
  for (const auto* verb : {"assemble", "disassemble"}) {
    std::istringstream options(information({"__complete", "options", "program", verb}));
    for (std::string option; std::getline(options, option);)
      EXPECT_THAT(page, HasSubstr(option)) << verb;
  }
}

}  // namespace
}  // namespace tmclctl
