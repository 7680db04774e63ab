/// Programs in files: text (*.tmc), or the bytes of a program file (*.bin).
#pragma once

#include <string>

#include "output/errors.hpp"
#include "output/screen.hpp"
#include "tmcl/assembler.hpp"

namespace tmclctl {

/// The bytes of a program file.
Result<tmcl::program::Program> read_program(const std::string& path);
/// A program's text. Problems are told on standard error, one a line; with --json in the failure.
Result<tmcl::program::Assembly> assemble_file(const std::string& path, Output& output,
                                              const tmcl::Model* model = nullptr);
/// The same of a program file: what 'program disassemble' makes of it.
Result<tmcl::program::Assembly> assembly_from(const std::string& path, Output& output,
                                              const tmcl::Model* model = nullptr);
/// Either, by the ending of its name: *.bin is a program file.
Result<tmcl::program::Program> program_from(const std::string& path, Output& output);

}  // namespace tmclctl
