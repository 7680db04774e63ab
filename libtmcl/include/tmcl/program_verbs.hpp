/// Stand-alone programs in a module: loading, reading, running.
///
/// While a module is in download mode it records whatever it is sent. So loading keeps the module
/// for itself (Hold): commands of others wait, and a stop ends the download before it goes out.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/program.hpp"
#include "tmcl/script.hpp"

namespace tmcl {

struct LoadProgress {
  enum class Phase : std::uint8_t { writing, comparing };
  Phase phase = Phase::writing;
  std::size_t done = 0;
  std::size_t of = 0;
};
/// Told after each command of the program; false ends the verb there.
using OnLoadProgress = std::function<bool(const LoadProgress&)>;

struct LoadOptions {
  std::uint16_t first_address = 0;
  /// A lost or garbled answer within a download leaves in doubt what was recorded: the section is
  /// downloaded anew, so often at most. 1..10
  unsigned attempts = 3;
  /// Read everything back and compare it. Impossible while global parameter 81 forbids reading.
  bool compare = true;
  OnLoadProgress progress{};
};

struct ReadOptions {
  std::uint16_t first_address = 0;
  /// Nothing: up to the first empty_lines_after_a_program empty ones, or the end of the memory.
  std::optional<std::uint16_t> length{};
  OnLoadProgress progress{};
};

/// So many empty commands (command 0) in a row come after a program and not within one.
constexpr std::size_t empty_lines_after_a_program = 16;

struct ProgramStatus {
  enum class State : std::uint8_t { stopped = 0, running = 1, stepping = 2, reset = 3 };
  State state = State::stopped;
  std::optional<std::int32_t> next_address;  ///< Global parameter 130, where the module has it.
  std::optional<std::int32_t> last_error;    ///< Global parameter 131, where the module has it.
};

struct StepOptions {
  /// Addresses: it ends before a command that stands there, but executes the first one anyhow.
  std::vector<std::uint16_t> until{};
  std::uint32_t most_steps = 1;
  /// For one command: a WAIT may take its time.
  Duration longest_wait = std::chrono::seconds(60);
  /// Told before each command how many were executed, and now and then while one waits; false ends
  /// the verb there.
  std::function<bool(std::uint32_t steps)> progress{};
};

struct SteppedProgram {
  enum class Reason : std::uint8_t {
    at_address,  ///< The next command is at one of the addresses.
    ended,       ///< The program has ended, failed, or was stopped.
    steps,       ///< So many commands were executed.
    waits,       ///< A WAIT takes longer than it may here. It goes on, and the program halts then.
    cancelled,   ///< By `progress`. A WAIT goes on.
  };
  Reason reason = Reason::steps;
  std::uint32_t steps = 0;  ///< Commands that were executed, one that still waits included.
  ProgramStatus status{};
};

namespace verbs {

/// Loads a program and compares what the module holds then. In an order in which no half of it can
/// ever run: an empty command at the first address, everything behind it, and the first command
/// last.
/// Errors, besides those of the exchanges:
/// Errc::bad_argument     an empty program, one too long, or a command that is none for programs;
/// Errc::refused_by_module, unsent  the memory is protected (global parameter 81), or a program
///                        runs;
/// Errc::superseded_by_stop  a stop came meanwhile;
/// Errc::download_broken  `progress` ended it, or the module executed a line instead of recording
///                        it (a motor that this may have started has been sent a stop);
/// Errc::unexpected_value  the module holds something else, after all attempts.
/// After an error the module is out of download mode, if it can be reached at all, and holds no
/// program that would start at the first address; but for a compare that fails at the very end.
Script<Result<void>> load_program(ModuleAddress module, program::Program program,
                                  LoadOptions options = {});
/// Reads what the module holds.
Script<Result<program::Program>> read_program(ModuleAddress module, ReadOptions options = {});
/// Errors: Errc::unexpected_value names the first command that differs.
Script<Result<void>> compare_program(ModuleAddress module, program::Program program,
                                     LoadOptions options = {});

/// Runs the program from an address, or from where it stands (RUN_APPLICATION).
Script<Result<void>> run_program(ModuleAddress module,
                                 std::optional<std::uint16_t> address = std::nullopt);
/// Ends the program (STOP_APPLICATION); motors go on.
Script<Result<void>> stop_program(ModuleAddress module);
/// Executes one command (STEP_APPLICATION).
Script<Result<void>> step_program(ModuleAddress module);
/// Ends the program and sets it back to its start (RESET_APPLICATION).
Script<Result<void>> reset_program(ModuleAddress module);
Script<Result<ProgramStatus>> program_status(ModuleAddress module);
/// Executes commands one by one. Errors, besides those of the exchanges: Errc::refused_by_module,
/// unsent, where a program runs, or the module does not tell the address of the next command.
Script<Result<SteppedProgram>> step_program_to(ModuleAddress module, StepOptions options);

// Breakpoints. No document at hand tells the types of command 141; here 0 adds, 1 deletes, 2
// deletes all, and 3 asks how many there may be.
Script<Result<void>> add_breakpoint(ModuleAddress module, std::uint16_t address);
Script<Result<void>> delete_breakpoint(ModuleAddress module, std::uint16_t address);
Script<Result<void>> delete_all_breakpoints(ModuleAddress module);
Script<Result<std::int32_t>> most_breakpoints(ModuleAddress module);

}  // namespace verbs
}  // namespace tmcl
