/// Runs a stand-alone program, command by command, in whatever time it is told.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/program/calculator.hpp"
#include "sim/program/host.hpp"
#include "sim/program/interrupts.hpp"
#include "sim/program/memory.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/program.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

/// So long a command takes. The manuals give no figure.
constexpr Duration command_time = std::chrono::microseconds(100);
/// Of the command WAIT.
constexpr Duration wait_tick = std::chrono::milliseconds(10);
/// Subroutines within subroutines, as the vendor's firmware headers have it.
constexpr std::size_t deepest_call = 8;
constexpr std::size_t most_breakpoints = 10;  ///< The same.

/// Whether a command means the same when a host sends it as within a program. (Those that take a
/// value from the accumulator do not, nor do jumps.)
bool is_direct(Command command);
/// Whether a host may send a command that works on the accumulator, the X register, user variables
/// or interrupts of the program. It shares them with a program that runs.
bool is_direct_calculation(Command command);

/// Commands that a host could send as well go to the module, and what they read goes to the
/// accumulator. A command that fails ends the program and stays the current one; last_error() then
/// tells the status that the command would be answered with, which is:
///
/// - invalid_command for a command that has no place in a program,
/// - wrong_type for an unknown type, and for an interrupt that the module does not have,
/// - invalid_value for an address beyond the memory (and for running on to there), a motor or
///   variable that does not exist, a negative time, and a division by zero,
/// - maximum_exceeded for a subroutine too many,
/// - command_not_available for a return from where nothing was called, and for RETI outside of an
///   interrupt,
/// - whatever the module answers to a command that it executes.
///
/// Command 0, where nothing was written, ends a program without an error.
///
/// The condition ZE means that what was last calculated or read is 0; EQ to LE belong to the last
/// comparison. An interrupt saves accumulator, X register, conditions and a WAIT that it cuts
/// short, which goes on afterwards without losing time; error flags are not saved. No interrupt
/// comes within another.
class Processor {
 public:
  /// Numbers are those of global parameter 128.
  enum class State : std::uint8_t { stopped = 0, running = 1, stepping = 2, reset = 3 };

  /// Both must outlive the processor.
  Processor(const ProgramMemory& memory, ProgramHost& host)
      : memory_(&memory), host_(&host), calculator_(host), interrupts_(host) {}

  /// As after power-on, except for breakpoints.
  void clear();
  void reset();
  /// Goes on where it is.
  void run(TimePoint now);
  /// Starts anew; the address must lie within the memory.
  void run_from(std::uint16_t address, TimePoint now);
  /// Executes one command and halts. A WAIT is done when it is over.
  void step(TimePoint now);
  void stop() { state_ = State::stopped; }

  /// A command for which is_direct_calculation() is true, by a host.
  Status execute_directly(const program::Instruction& line, TimePoint now) {
    return execute(line, now);
  }

  State state() const { return state_; }
  std::uint16_t counter() const { return counter_; }
  /// Why the program ended; nothing if it did not fail.
  std::optional<Status> last_error() const { return last_error_; }

  /// What no real module tells.
  struct Inside {
    State state = State::stopped;
    std::uint16_t counter = 0;
    std::optional<Status> last_error{};
    Calculator::Registers registers{};
    std::uint8_t errors = 0;                 ///< A bit for each of ETO, EAL, EDV, EPO and ESD.
    std::vector<std::uint16_t> calls{};      ///< Where subroutines return to, the outermost first.
    std::optional<std::uint16_t> resumes{};  ///< Within an interrupt: where the program goes on.
    bool is_busy = false;                    ///< It runs, or a step is not over.
    TimePoint ready{};                       ///< When the next command can begin.
  };
  Inside inside() const;

  /// The program halts before it executes this command. False if there are too many already.
  bool add_breakpoint(std::uint16_t address);
  void remove_breakpoint(std::uint16_t address);
  void remove_breakpoints() { breakpoints_.clear(); }

  /// Executes what is due, at most one command. To be called when next_due() has come, and whenever
  /// something of the module has changed.
  void run_due(TimePoint now);
  /// `never` if the program does not run, or waits for what cannot be foreseen.
  TimePoint next_due() const;

 private:
  enum class WaitFor : std::uint8_t { ticks, position, reference_switch, limit_switch, search };
  struct Wait {
    WaitFor what;
    std::uint8_t motor;
    TimePoint end;  // when the time is over, or the patience
  };
  struct Context {
    Calculator::Registers registers;
    std::uint16_t counter;
    std::optional<Wait> wait;
  };
  /// In the order of the conditions of JC from ETO on, and of the types of CLE after ALL.
  enum class ErrorFlag : std::uint8_t { timeout, alarm, deviation, position, shutdown };

  bool active() const;
  void begin(State state, TimePoint now);
  void observe(TimePoint now);
  void raise(ErrorFlag flag) { errors_ = static_cast<std::uint8_t>(errors_ | bit_of(flag)); }
  static constexpr unsigned bit_of(ErrorFlag flag) { return 1U << static_cast<unsigned>(flag); }
  void enter_interrupt(TimePoint now);
  /// False if there is nothing more to do now.
  bool finish_wait(TimePoint now);
  bool has_happened(const Wait& wait) const;
  bool at_breakpoint() const;
  void execute_next(TimePoint now);
  void fail(Status status);

  Status execute(const program::Instruction& line, TimePoint now);
  Status perform(const program::Instruction& line);
  Status jump_if(bool condition, std::int32_t address);
  Status call_if(bool condition, std::int32_t address);
  Status return_from_call();
  Status return_from_interrupt();
  Status restart(std::int32_t address);
  Status count_down(const program::Instruction& line);
  Status switch_interrupt(const program::Instruction& line, TimePoint now);
  Status set_vector(const program::Instruction& line);
  Status begin_wait(const program::Instruction& line, TimePoint now);
  Status end_program();
  Status clear_errors(const program::Instruction& line);

  bool condition(std::uint8_t type) const;

  const ProgramMemory* memory_;
  ProgramHost* host_;
  Calculator calculator_;
  Interrupts interrupts_;

  State state_ = State::stopped;
  bool step_pending_ = false;
  std::uint16_t counter_ = 0;
  std::uint16_t next_ = 0;   // where the present command leads
  std::uint8_t errors_ = 0;  // a bit for each ErrorFlag
  std::vector<std::uint16_t> calls_;
  std::optional<Context> interrupted_;
  std::optional<Wait> wait_;
  TimePoint ready_{};  // when the next command begins
  TimePoint observed_{};
  std::optional<Status> last_error_;
  std::vector<std::uint16_t> breakpoints_;
  bool past_breakpoint_ = false;
};

}  // namespace tmcl::sim
