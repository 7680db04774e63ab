// Programs as text: what each line becomes, and what is said of what is wrong.
#include "tmcl/assembler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "tmcl/parameter.hpp"

namespace tmcl::program {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using Files = std::map<std::string, std::string>;

ReadFile reader_of(const Files& files) {
  return [&files](const std::string& path) -> tl::expected<std::string, std::string> {
    const auto file = files.find(path);
    if (file == files.end()) return tl::unexpected(std::string("No such file or directory"));
    return file->second;
  };
}

tl::expected<Assembly, TextProblems> assembled(const Files& files) {
  return assemble("main.tmc", reader_of(files));
}

std::vector<std::string> problems_of(const Files& files) {
  std::vector<std::string> texts;
  if (const auto assembly = assembled(files); !assembly) {
    for (const auto& problem : assembly.error()) texts.push_back(describe(problem));
  }
  return texts;
}
std::vector<std::string> problems_of(const std::string& text) {
  return problems_of(Files{{"main.tmc", text}});
}

Assembly assembly_of(const std::string& text) {
  auto assembly = assembled({{"main.tmc", text}});
  if (!assembly) throw std::runtime_error(describe(assembly.error().front()));
  return std::move(*assembly);
}
Program program_of(const std::string& text) { return assembly_of(text).program; }

/// The value that an expression has.
std::int32_t value_of(const std::string& expression) {
  return program_of("COMP " + expression).at(0).value;
}
std::string problem_of_value(const std::string& expression) {
  const auto problems = problems_of("COMP " + expression);
  return problems.empty() ? "" : problems.front();
}

struct Example {
  const char* text;
  std::vector<std::uint8_t> bytes;  ///< Without the sum.
};

// "Binary form of ..." of the TMCM-1290 firmware manual (DJNZ and RETI by their tables: the
// examples there have misprints), without the address and with the labels' addresses as numbers.
const std::vector<Example> manual = {
    {"ROR 0, 51200", {0x01, 0, 0, 0, 0, 0xC8, 0}},
    {"MVP ABS, 0, 90000", {0x04, 0, 0, 0, 1, 0x5F, 0x90}},
    {"CALC MUL, -5000", {0x13, 2, 0, 0xFF, 0xFF, 0xEC, 0x78}},
    {"JC GE, 10", {0x15, 5, 0, 0, 0, 0, 10}},
    {"JA 10", {0x16, 0, 0, 0, 0, 0, 10}},
    {"CSUB 100", {0x17, 0, 0, 0, 0, 0, 100}},
    {"RSUB", {0x18, 0, 0, 0, 0, 0, 0}},
    {"EI 255", {0x19, 255, 0, 0, 0, 0, 0}},
    {"DI 255", {0x1A, 255, 0, 0, 0, 0, 0}},
    {"WAIT POS, 0, 0", {0x1B, 1, 0, 0, 0, 0, 0}},
    {"WAIT TICKS, 0, -1", {0x1B, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF}},
    {"STOP", {0x1C, 0, 0, 0, 0, 0, 0}},
    {"SCO 1, 0, 1000", {0x1E, 1, 0, 0, 0, 3, 0xE8}},
    {"SCO 0, 255, 0", {0x1E, 0, 255, 0, 0, 0, 0}},
    {"GCO 1, 0", {0x1F, 1, 0, 0, 0, 0, 0}},
    {"GCO 0, 255, 0", {0x1F, 0, 255, 0, 0, 0, 0}},
    {"CCO 3, 0", {0x20, 3, 0, 0, 0, 0, 0}},
    {"CALCX MUL", {0x21, 2, 0, 0, 0, 0, 0}},
    {"AAP 0, 0", {0x22, 0, 0, 0, 0, 0, 0}},
    {"AGP 42, 2", {0x23, 42, 2, 0, 0, 0, 0}},
    {"CLE ETO", {0x24, 1, 0, 0, 0, 0, 0}},
    {"VECT 255, 50", {0x25, 255, 0, 0, 0, 0, 50}},
    {"RETI", {0x26, 0, 0, 0, 0, 0, 0}},
    {"ACO 1, 0", {0x27, 1, 0, 0, 0, 0, 0}},
    {"CALCVV SUB, 65, 42", {0x28, 1, 65, 0, 0, 0, 42}},
    {"CALCVA SUB, 27", {0x29, 1, 27, 0, 0, 0, 0}},
    {"CALCAV SUB, 27", {0x2A, 1, 27, 0, 0, 0, 0}},
    {"CALCVX SUB, 27", {0x2B, 1, 27, 0, 0, 0, 0}},
    {"CALCXV COMP, 27", {0x2C, 11, 27, 0, 0, 0, 0}},
    {"CALCV SUB, 27, 5000", {0x2D, 1, 27, 0, 0, 0x13, 0x88}},
    {"MVPA ABS, 0", {0x2E, 0, 0, 0, 0, 0, 0}},
    {"RST 10", {0x30, 0, 0, 0, 0, 0, 10}},
    {"DJNZ 42, 1", {0x31, 42, 0, 0, 0, 0, 1}},
    {"ROLA 0", {0x32, 0, 0, 0, 0, 0, 0}},
    {"RORA 0", {0x33, 0, 0, 0, 0, 0, 0}},
    {"SIV 3", {0x37, 0, 0, 0, 0, 0, 3}},
    {"GIV", {0x38, 0, 0, 0, 0, 0, 0}},
    {"AIV", {0x39, 0, 0, 0, 0, 0, 0}},
    {"CALL LT, 100", {0x50, 6, 0, 0, 0, 0, 100}},
    // Several motors at once, however the module codes them.
    {"MVP COORD, $47, 3", {0x04, 2, 0x47, 0, 0, 0, 3}},
    {"UF3", {0x43, 0, 0, 0, 0, 0, 0}},
    {"UF3 1, 2, 3", {0x43, 1, 2, 0, 0, 0, 3}},
};

TEST(Assembler, CommandsAreTheBytesOfTheManual) {
  for (const auto& example : manual) {
    auto expected = example.bytes;
    std::uint8_t sum = 0;
    for (const auto byte : expected) sum = static_cast<std::uint8_t>(sum + byte);
    expected.push_back(sum);
    EXPECT_EQ(to_bytes(program_of(example.text)), expected) << example.text;
  }
}

// From chapter "TMCL Programming Techniques and Structure" of the firmware manuals.
TEST(Assembler, AProgramOfTheManual) {
  const Files files = {{"main.tmc", R"(//Define some constants
#include TMCLParam.tmc
MaxSpeed = 50000
Position0 = 0
Position1 = 500000

SAP APMaxPositioningSpeed, Motor0, MaxSpeed
MainLoop:
  MVP ABS, Motor0, Position1
  WAIT POS, Motor0, 0
  MVP ABS, Motor0, Position0
  WAIT POS, Motor0, 0
  JA MainLoop
)"},
                       {"TMCLParam.tmc", "APMaxPositioningSpeed = 4\nMotor0 = 0"}};
  const auto assembly = assembled(files);
  ASSERT_TRUE(assembly);
  EXPECT_THAT(
      assembly->program,
      ElementsAre(Instruction{Command::SAP, 4, 0, 50000}, Instruction{Command::MVP, 0, 0, 500000},
                  Instruction{Command::WAIT, 1, 0, 0}, Instruction{Command::MVP, 0, 0, 0},
                  Instruction{Command::WAIT, 1, 0, 0}, Instruction{Command::JA, 0, 0, 1}));
  ASSERT_THAT(assembly->labels, SizeIs(1));
  EXPECT_EQ(assembly->labels[0].name, "MainLoop");
  EXPECT_EQ(assembly->labels[0].address, 1U);
  EXPECT_THAT(assembly->files, ElementsAre("main.tmc", "TMCLParam.tmc"));
}

TEST(Assembler, LabelsStandAnywhere) {
  const auto assembly = assembly_of("JA End\nA: B: C:STOP\n  VECT 3, b\nEnd:");
  EXPECT_THAT(assembly.program,
              ElementsAre(Instruction{Command::JA, 0, 0, 3}, Instruction{Command::STOP},
                          Instruction{Command::VECT, 3, 0, 1}));
  EXPECT_THAT(assembly.labels, SizeIs(4));
}

TEST(Assembler, NamesMayBeThoseOfCommandsAndTypes) {
  EXPECT_THAT(program_of("stop = 7\nwait: COMP stop\nJA WAIT\nABS = 1\nMVP ABS, ABS, 0"),
              ElementsAre(Instruction{Command::COMP, 0, 0, 7}, Instruction{Command::JA, 0, 0, 0},
                          Instruction{Command::MVP, 0, 1, 0}));
}

TEST(Assembler, TypesAreNamesConstantsOrNumbers) {
  EXPECT_THAT(program_of("Relative = 1\nMVP Relative, 0, 5\nmvp rel, 0, 5\nMVP 0 + 1, 0, 5"),
              testing::Each(Instruction{Command::MVP, 1, 0, 5}));
}

TEST(Assembler, CommentsAreBlanks) {
  EXPECT_THAT(program_of("/* a\nSTOP\n*/ SAP /*x*/4,0/**/, 9 // , 1\n// STOP /*\n"),
              ElementsAre(Instruction{Command::SAP, 4, 0, 9}));
}

TEST(Assembler, AnyByteMayBeInAComment) {
  EXPECT_THAT(program_of("\xEF\xBB\xBFSTOP // \xFC\x1B /* \r\nSTOP/* \" // */\r\n"), SizeIs(2));
}

TEST(Assembler, RawIsAnyCommand) {
  EXPECT_THAT(program_of(".raw 250, 1, 2, -3\n.RAW MyCommand, 255, 255, $FFFFFFFF\nMyCommand = 0"),
              ElementsAre(Instruction{static_cast<Command>(250), 1, 2, -3},
                          Instruction{static_cast<Command>(0), 255, 255, -1}));
}

TEST(AssemblerExpression, NumbersHaveThreeForms) {
  EXPECT_EQ(value_of("010"), 10);
  EXPECT_EQ(value_of("$Ff"), 255);
  EXPECT_EQ(value_of("0xfF"), 255);
  EXPECT_EQ(value_of("%1010"), 10);
  EXPECT_EQ(value_of("2147483647"), INT32_MAX);
  EXPECT_EQ(value_of("-2147483648"), INT32_MIN);
  EXPECT_EQ(value_of("$FFFFFFFF"), -1);
  EXPECT_EQ(value_of("$80000000"), INT32_MIN);
  EXPECT_EQ(value_of("%10000000000000000000000000000000"), INT32_MIN);
}

TEST(AssemblerExpression, OperatorsBindAsInC) {
  EXPECT_EQ(value_of("2+3*4"), 14);
  EXPECT_EQ(value_of("(2+3)*4"), 20);
  EXPECT_EQ(value_of("10-3-2"), 5);
  EXPECT_EQ(value_of("100/7/2"), 7);
  EXPECT_EQ(value_of("10 % 4"), 2);
  EXPECT_EQ(value_of("10 %11"), 10) << "behind a value it is the operator";
  EXPECT_EQ(value_of("10 % %11"), 1);
  EXPECT_EQ(value_of("-7/2"), -3);
  EXPECT_EQ(value_of("-7%4"), -3);
  EXPECT_EQ(value_of("1|2^3&6"), 1 | (2 ^ (3 & 6)));
  EXPECT_EQ(value_of("1+2&3"), (1 + 2) & 3);
  EXPECT_EQ(value_of("~$FF"), -256);
  EXPECT_EQ(value_of("- - + 5"), 5);
  EXPECT_EQ(value_of("3000000000*2/6"), 1000000000);
}

TEST(AssemblerExpression, SaysWhatIsWrong) {
  EXPECT_EQ(problem_of_value("1/(3-3)"), "main.tmc:1:7: division by 0");
  EXPECT_EQ(problem_of_value("5%0"), "main.tmc:1:7: division by 0");
  EXPECT_EQ(problem_of_value("(1+2"), "main.tmc:1:10: ')' is missing");
  EXPECT_EQ(problem_of_value("1 2"), "main.tmc:1:8: '2' is not expected here");
  EXPECT_EQ(problem_of_value("1+"), "main.tmc:1:8: a value is missing");
  EXPECT_EQ(problem_of_value("$"), "main.tmc:1:6: a value is missing");
  EXPECT_EQ(problem_of_value("%102"), "main.tmc:1:6: '102' is no binary number");
  EXPECT_EQ(problem_of_value("12a"), "main.tmc:1:6: '12a' is no decimal number");
  EXPECT_EQ(problem_of_value("0xG"), "main.tmc:1:6: 'G' is no hexadecimal number");
  EXPECT_EQ(problem_of_value("$100000000"), "main.tmc:1:6: '100000000' is too large a number");
  EXPECT_EQ(problem_of_value("99999999999999999999"),
            "main.tmc:1:6: '99999999999999999999' is too large a number");
  EXPECT_EQ(problem_of_value("9223372036854775807+1"), "main.tmc:1:25: the result exceeds 64 bits");
  EXPECT_EQ(problem_of_value("(-9223372036854775807-1)/-1"),
            "main.tmc:1:30: the result exceeds 64 bits");
  EXPECT_EQ(problem_of_value("-(-9223372036854775807-1)"),
            "main.tmc:1:6: the result exceeds 64 bits");
  EXPECT_EQ(problem_of_value("2147483648"),
            "main.tmc:1:6: value is -2147483648..2147483647, not 2147483648");
  EXPECT_THAT(problem_of_value(std::string(400, '(') + '1' + std::string(400, ')')),
              HasSubstr("nested too deep"));
  EXPECT_THAT(problem_of_value(std::string(900, '-') + '1'), HasSubstr("nested too deep"));
}

TEST(AssemblerProblems, AllOfThemInTheirOrder) {
  const Files files = {{"main.tmc", R"(Loop: MVPP ABS, 0, 1
  MVP ABSO, 0, 1
#include "inner.tmc"
  MVP ABS, 0
  JA Lop
  SAP 256, 0, 1
  SAP 4, -1, 1
  SAP 4, , 1
  STOP 1
  JA 2048
  Loop = 3
  ? STOP
  FACTORY_RESET
  GCO 1
  #define X 1
)"},
                       {"inner.tmc", "\n  EI"}};
  EXPECT_THAT(
      problems_of(files),
      ElementsAre("main.tmc:1:7: there is no command 'MVPP'. Did you mean 'MVP'?",
                  "main.tmc:2:7: MVP has no type 'ABSO'. Did you mean 'ABS'?",
                  "inner.tmc:2:3: EI takes 1 operand (interrupt), not 0",
                  "main.tmc:4:3: MVP takes 3 operands (type, motor, position), not 2",
                  "main.tmc:5:6: 'Lop' is not defined. Did you mean 'Loop'?",
                  "main.tmc:6:7: parameter is 0..255, not 256",
                  "main.tmc:7:10: motor is 0..255, not -1", "main.tmc:8:10: a value is missing",
                  "main.tmc:9:3: STOP takes no operands, not 1",
                  "main.tmc:10:6: address is 0..2047, not 2048",
                  "main.tmc:11:3: 'Loop' is defined already, in main.tmc:1",
                  "main.tmc:12:3: '?' begins no command, label or constant",
                  "main.tmc:13:3: FACTORY_RESET is for hosts, not for programs",
                  "main.tmc:14:3: GCO takes 2 to 3 operands (coordinate, motor, value), not 1",
                  "main.tmc:15:3: '#define' is no directive; there is only #include"));
}

TEST(AssemblerProblems, NameTheWord) {
  const auto assembly = assembled({{"main.tmc", "SAP 4, 0, 1 + Spede\nJA 3000+1"}});
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().at(0).word, "Spede");
  EXPECT_EQ(assembly.error().at(1).word, "3000+1");
}

TEST(AssemblerProblems, ConstantsComeBeforeWhatTheyMake) {
  EXPECT_THAT(problems_of("A = B\nB = 1"), ElementsAre("main.tmc:1:5: 'B' is not defined"));
  EXPECT_THAT(problems_of("L: STOP\nA = L"),
              ElementsAre("main.tmc:2:5: 'L' is a label; constants are made of constants only"));
  EXPECT_THAT(problems_of("A = A"), SizeIs(1));
  EXPECT_THAT(problems_of("A = 1/0\nCOMP A"), SizeIs(1)) << "one cause, one problem";
  EXPECT_THAT(problems_of("a = 1\nA: STOP"),
              ElementsAre("main.tmc:2:1: 'A' is defined already, in main.tmc:1"));
}

TEST(AssemblerProblems, ACommandOfAnotherAssemblerIsNoneThatIsSpelledSo) {
  EXPECT_THAT(problems_of("RET"),
              ElementsAre("main.tmc:1:1: there is no command 'RET'. RSUB returns from CSUB and "
                          "CALL, RETI from an interrupt"));
  for (const auto* text : {"ret", "RETURN", "JMP 1", "GOTO 1", "GOSUB 1", "END", "HALT", "MOV 1"})
    EXPECT_THAT(problems_of(text), ElementsAre(testing::Not(HasSubstr("Did you mean")))) << text;
}

TEST(Assembler, NamesOfParametersAreConstantsAsTheIdeHasThem) {
  const auto type_of = [](const std::string& name) {
    const auto program =
        program_of("#include \"TMCLParam.tmc\"\nSAP " + name + ", 0, 1000\nOwn = " + name + "\n");
    return static_cast<int>(program.at(0).type);
  };
  EXPECT_EQ(type_of("VMax"), 4);
  EXPECT_EQ(type_of("max_velocity"), 4);
  EXPECT_EQ(type_of("MaxPositioningSpeed"), 4);
  EXPECT_EQ(type_of("ActualPosition"), 1);
  EXPECT_EQ(type_of("MICROSTEP_RESOLUTION"), 140);
  // Not without that file, and not where the number depends on the model.
  EXPECT_THAT(problems_of("SAP MaxVelocity, 0, 1000"), SizeIs(1));
  EXPECT_THAT(problems_of("#include TMCLParam.tmc\nSAP nonsense, 0, 1"), SizeIs(1));
  EXPECT_THAT(
      problems_of("#include TMCLParam.tmc\nSAP ramp_mode, 0, 1"),
      ElementsAre("main.tmc:2:5: 'ramp_mode' is 128 on a TMCM-142, 138 on a TMCM-351: write "
                  "the number, or name the model of the module"));
  EXPECT_THAT(problems_of("#include TMCLParam.tmc\nSAP Mode, 0, 1"),
              ElementsAre("main.tmc:2:5: 'Mode' is not defined, nor an axis parameter"));
  EXPECT_THAT(problems_of("#include TMCLParam.tmc\nSAP max_velocty, 0, 1"),
              ElementsAre(HasSubstr("Did you mean 'max_velocity'?")));
  // What a program defines itself comes first, and so does a file of that name.
  EXPECT_EQ(program_of("#include TMCLParam.tmc\nVMax = 7\nSAP VMax, 0, 1").at(0).type, 7);
  const auto own = assembled(
      {{"main.tmc", "#include TMCLParam.tmc\nSAP VMax, 0, 1"}, {"TMCLParam.tmc", "VMax = 9"}});
  ASSERT_TRUE(own);
  EXPECT_EQ(own->program.at(0).type, 9);
}

TEST(Assembler, NamesOfParametersAreThoseOfTheModelThatIsNamed) {
  for (const auto& model : models()) {
    for (const auto& row : axis_parameters(model)) {
      const Files one{
          {"main.tmc", "#include TMCLParam.tmc\nSAP " + std::string(row.name) + ", 0, 0"}};
      const auto assembly = assemble("main.tmc", reader_of(one), &model);
      ASSERT_TRUE(assembly) << model.name << ' ' << row.name;
      ASSERT_EQ(assembly->program.at(0).type, row.number) << model.name << ' ' << row.name;
    }
  }
}

TEST(AssemblerProblems, Raw) {
  EXPECT_THAT(
      problems_of(".raw 1, 2, 3"),
      ElementsAre("main.tmc:1:1: .raw takes 4 operands (command, type, motor, value), not 3"));
  EXPECT_THAT(problems_of(".raw 256, 0, 0, 0"),
              ElementsAre("main.tmc:1:6: command is 0..255, not 256"));
  EXPECT_THAT(problems_of(".row 256, 0, 0, 0"),
              ElementsAre("main.tmc:1:1: there is no command '.row'. Did you mean '.raw'?"));
}

TEST(AssemblerProblems, FilesThatCannotBeIncluded) {
  EXPECT_THAT(problems_of(Files{}),
              ElementsAre("main.tmc: cannot be read: No such file or directory"));
  EXPECT_THAT(problems_of("#include \"gone.tmc\""),
              ElementsAre("main.tmc:1:10: 'gone.tmc' cannot be read: No such file or directory"));
  EXPECT_THAT(problems_of("#include"), ElementsAre("main.tmc:1:9: the name of a file is missing"));
  EXPECT_THAT(problems_of("#include \"x"), SizeIs(1));
  EXPECT_THAT(
      problems_of(Files{{"main.tmc", "#INCLUDE a.tmc"}, {"a.tmc", "#include x/../main.tmc"}}),
      ElementsAre("a.tmc:1:10: 'x/../main.tmc' includes itself"));
}

TEST(Assembler, IncludedFilesStandBesideWhoIncludesThem) {
  const Files files = {{"main.tmc", "#include \"sub/a.tmc\"\nCOMP B"},
                       {"sub/a.tmc", "#include b.tmc // B"},
                       {"sub/b.tmc", "B = 4"}};
  const auto assembly = assembled(files);
  ASSERT_TRUE(assembly);
  EXPECT_EQ(assembly->program.at(0).value, 4);
}

TEST(AssemblerProblems, WhatIsNoText) {
  EXPECT_THAT(problems_of("STOP\n/* for ever"),
              ElementsAre("main.tmc:2:1: this comment does not end"));
  EXPECT_THAT(problems_of(std::string("STOP\nA\0B\nC", 10)),
              ElementsAre("main.tmc:2:2: here is a byte 0: this is no text"));
  EXPECT_THAT(problems_of("STOP\x1B[2J"), testing::Each(testing::Not(HasSubstr("\x1B"))));
}

TEST(AssemblerBounds, OfTheText) {
  EXPECT_THAT(problems_of(std::string(longest_line, ' ') + "\nSTOP"), IsEmpty());
  EXPECT_THAT(problems_of(std::string(longest_line + 1, ' ') + "\nSTOP"),
              ElementsAre("main.tmc:1:1001: a line has at most 1000 bytes"));
  EXPECT_THAT(problems_of(std::string(most_source_lines, '\n')), IsEmpty());
  EXPECT_THAT(problems_of(std::string(most_source_lines + 1, '\n')),
              ElementsAre("main.tmc: a program's text has at most 50000 lines"));
  EXPECT_THAT(problems_of(std::string(most_source_bytes + 1, ' ')),
              ElementsAre("main.tmc: a program's text has at most 4000000 bytes"));
  EXPECT_THAT(problems_of(std::string(longest_name, 'n') + ": STOP"), IsEmpty());
  EXPECT_THAT(problems_of(std::string(longest_name + 1, 'n') + ": STOP"),
              ElementsAre(HasSubstr("a name has at most 64")));
}

TEST(AssemblerBounds, OfTheProgram) {
  std::string text;
  for (std::size_t i = 0; i < most_commands; ++i) text += "STOP\n";
  EXPECT_THAT(program_of(text), SizeIs(most_commands));
  EXPECT_THAT(
      problems_of(text + "STOP\nSTOP"),
      ElementsAre("main.tmc:2049:1: a program has at most 2048 commands; this is one more"));
}

TEST(AssemblerBounds, OfTheFiles) {
  Files files{{"main.tmc", "#include f1"}};
  for (std::size_t i = 1; i <= deepest_include; ++i)
    files["f" + std::to_string(i)] = "#include f" + std::to_string(i + 1);
  files["f" + std::to_string(deepest_include)] = "STOP";
  EXPECT_THAT(problems_of(files), IsEmpty());
  files["f" + std::to_string(deepest_include)] = "#include last";
  files["last"] = "STOP";
  EXPECT_THAT(problems_of(files), ElementsAre("f16:1:10: files are included more than 16 deep"));

  // Each doubles the number of files.
  Files doubling{{"main.tmc", "#include d0\n#include d0"}, {"d9", "STOP"}};
  for (int i = 0; i < 9; ++i) {
    const auto next = "#include d" + std::to_string(i + 1) + '\n';
    doubling["d" + std::to_string(i)] = next + next;
  }
  std::size_t reads = 0;
  const auto read = reader_of(doubling);
  const auto assembly = assemble("main.tmc", [&](const std::string& path) {
    ++reads;
    return read(path);
  });
  ASSERT_FALSE(assembly);
  EXPECT_EQ(reads, most_files);
  EXPECT_THAT(describe(assembly.error().front()), HasSubstr("more than 100 files"));
}

TEST(AssemblerBounds, OfTheProblems) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "NOPE\n";
  EXPECT_THAT(problems_of(text), SizeIs(most_problems));
  std::string operators;
  for (int i = 0; i < 1000; ++i) operators += "!\n";
  EXPECT_THAT(problems_of(operators), SizeIs(most_problems));
}

TEST(Listing, ShowsAddressBytesAndText) {
  const auto assembly =
      assembled({{"main.tmc", "#include c\nLoop:\n  MVP ABS, 0, Far // \x1B\n\n  JA Loop"},
                 {"c", "Far = -2"}});
  ASSERT_TRUE(assembly);
  EXPECT_EQ(listing(*assembly),
            "                                  1  #include c\n"
            "                                  1  Far = -2\n"
            "                                  2  Loop:\n"
            "   0  04 00 00 FF FF FF FE FF     3    MVP ABS, 0, Far // ?\n"
            "                                  4\n"
            "   1  16 00 00 00 00 00 00 16     5    JA Loop\n");
}

}  // namespace
}  // namespace tmcl::program
