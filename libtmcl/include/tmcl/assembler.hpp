/// Text to stand-alone programs, in the language of the TMCL-IDE.
///
/// One command a line, as the firmware manuals write it: mnemonic, then type, motor or bank, and
/// value, with commas between them.
///
///     #include "speeds.tmc"               // the quotes may be left out
///     Motor0 = 0                          // a constant; it stands before those made of it
///     Far    = 2 * $C800 + %101           // decimal, hexadecimal ($ or 0x) and binary (%)
///     Loop:  MVP ABS, Motor0, Far         /* a label; alone on its line, too */
///            WAIT POS, Motor0, 0
///            JA Loop
///            .raw 250, 1, 2, 3            // any command, by its numbers
///
/// Case does not matter. Expressions know ( ) - + ~ before a value, * / %, + -, &, ^ and |, from
/// tight to loose, and compute with 64 bits; / rounds towards 0. Hexadecimal and binary numbers
/// from 2^31 to 2^32 - 1 are bit patterns: $FFFFFFFF is -1. A label may be used before it stands, a
/// label or constant may be called like a command, and a type's standard name comes before a
/// constant of this name.
///
/// Labels, constants, // comments, #include and the operands are those of the TMCM-1290 firmware
/// manual. It does not tell the other comments, the forms of numbers, the operators and their
/// order, what may be redefined, or where an included file is looked for: here all this is as in C
/// (with $ and % as in other assemblers), nothing may be defined twice, and a file is looked for
/// beside the one that includes it. The TMCL-IDE's TMCLParam.tmc need not be there: including it
/// makes names of axis parameters constants: those of a model, or, if none is named, those that
/// have one number on all. How several motors are coded in the motor number of MVP COORD is not
/// settled either: it is a number like any other.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/model.hpp"
#include "tmcl/program.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcl::program {

// The bounds of what is read.
constexpr std::size_t most_source_bytes = 4'000'000;  ///< All files together.
constexpr std::size_t most_source_lines = 50'000;     ///< All files together.
constexpr std::size_t longest_line = 1000;            ///< Bytes.
constexpr std::size_t longest_name = 64;              ///< Bytes, of a label or constant.
constexpr std::size_t most_files = 100;               ///< Read, counting a file as often as it is.
constexpr std::size_t deepest_include = 16;           ///< Files within files.
constexpr std::size_t most_problems = 100;            ///< Reported.

/// The contents of a file, or why it cannot be read, in words such as "No such file or directory".
/// Asked for no more than most_files files; what is larger than most_source_bytes need not be read
/// to its end.
using ReadFile = std::function<tl::expected<std::string, std::string>(const std::string& path)>;

struct SourceLine {
  std::size_t file = 0;  ///< Index into Assembly::files.
  std::size_t line = 0;  ///< From 1.
  std::string text;
  std::optional<std::size_t> address;  ///< Of the command that stands on it.
};

struct Label {
  std::string name;  ///< As it is written where it stands.
  std::size_t address = 0;
};

/// A program, and what it was made of.
struct Assembly {
  Program program;
  std::vector<std::string>
      files;  ///< In the order in which they are read; the first is the main one.
  std::vector<SourceLine> lines;  ///< Those of an included file follow the line that includes it.
  std::vector<Label> labels;      ///< In their order in the text.
};

/// All problems, in the order of the text, or none. `model`: whose parameters TMCLParam.tmc names;
/// null if it is not known.
tl::expected<Assembly, TextProblems> assemble(const std::string& path, const ReadFile& read,
                                              const Model* model = nullptr);

/// One row a line of source: address, the bytes of the program file, line number and text.
std::string listing(const Assembly& assembly);

}  // namespace tmcl::program
