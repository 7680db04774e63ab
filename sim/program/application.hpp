/// The stand-alone program of a module, as a host meets it: loaded, run and looked at by the
/// control functions, commands 128 to 135 and 141.
#pragma once

#include <cstdint>
#include <span>

#include "sim/module/answer.hpp"
#include "sim/program/host.hpp"
#include "sim/program/memory.hpp"
#include "sim/program/processor.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/program.hpp"

namespace tmcl::sim {

/// Global parameter 81: bits.
constexpr std::int32_t no_reading = 1;
constexpr std::int32_t no_writing = 2;

/// Types of BREAKPOINT. No manual tells them.
constexpr std::uint8_t breakpoint_add = 0;
constexpr std::uint8_t breakpoint_remove = 1;
constexpr std::uint8_t breakpoint_remove_all = 2;
constexpr std::uint8_t breakpoint_most = 3;  ///< How many there may be.

/// While a program is loaded, commands below 128 are stored; the control functions have no place in
/// a program and are executed, except that nothing can be run. Loading stops a running program and
/// takes effect when it ends: see ProgramMemory.
class Application {
 public:
  /// The host must outlive the application; it is not asked anything yet.
  explicit Application(ProgramHost& host) : host_(&host), processor_(memory_, host) {}

  /// Whether execute() is for this command.
  static bool is_control(Command command);
  /// Answers, in this order of errors:
  /// - wrong_type for an unknown type of RUN_APPLICATION or BREAKPOINT,
  /// - invalid_value for an address beyond the memory,
  /// - write_protected where global parameter 81 forbids reading or loading,
  /// - command_not_available for RUN_APPLICATION and STEP_APPLICATION during a download,
  /// - maximum_exceeded for a breakpoint too many,
  /// - download_not_possible for END_DOWNLOAD if there were more commands than memory: then
  ///   everything is as before.
  Answer execute(const Request& request, TimePoint now);

  /// Executes a command for which is_direct_calculation() is true, whether a program runs or not.
  /// Errors are those that would end a program.
  Answer execute_directly(const Request& request, TimePoint now);

  /// Whether a host's commands below 128 are for record().
  bool in_download() const { return memory_.in_download(); }
  /// Answers with command_loaded, or with maximum_exceeded if the memory is full.
  Answer record(const Request& request);

  /// What the module does when it is switched on, or reset: a download is forgotten, breakpoints
  /// are cleared, and the program starts if global parameter 77 says so.
  void power_on(bool start, TimePoint now);
  /// What global parameter 81 does when it is written: who allows reading again gets an empty
  /// memory. Whether the memory was emptied.
  bool change_protection(std::int32_t from, std::int32_t to);

  /// Always most_commands commands.
  std::span<const program::Instruction> memory() const { return memory_.lines(); }
  /// Replaces the whole memory; the program stops.
  void load(std::span<const program::Instruction> lines);

  std::int32_t status() const { return static_cast<std::int32_t>(processor_.state()); }
  std::int32_t download_mode() const { return in_download() ? 1 : 0; }
  std::int32_t program_counter() const { return processor_.counter(); }
  /// The status that explains why the program ended; 0 if it did not fail. What real modules put
  /// there is not documented.
  std::int32_t last_error() const;
  Processor::Inside inside() const { return processor_.inside(); }

  /// See Processor.
  void run_due(TimePoint now) { processor_.run_due(now); }
  TimePoint next_due() const { return processor_.next_due(); }

 private:
  /// What GET_APPLICATION_STATUS answers.
  std::int32_t state_and_address() const;
  Answer run(const Request& request, TimePoint now);
  Answer step(const Request& request, TimePoint now);
  Answer begin_download(const Request& request);
  Answer end_download(const Request& request);
  Answer read(const Request& request) const;
  Answer set_breakpoint(const Request& request);
  bool protects(std::int32_t what) const { return (host_->code_protection() & what) != 0; }

  ProgramHost* host_;
  ProgramMemory memory_;
  Processor processor_;
};

}  // namespace tmcl::sim
