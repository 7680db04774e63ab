/// A debugger of stand-alone programs without I/O: it is told what is typed and what the program
/// does, and says what is to be done and printed. A module, or a simulated one, carries that out.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/assembler.hpp"

namespace tmcl::program {

/// Where a command stands in the text.
struct Place {
  std::uint16_t address = 0;
  std::string file{};
  std::size_t line = 0;
  std::string label{};  ///< "Loop", or "Loop+2" behind it; empty before the first label.
  std::string text{};   ///< Of the line, without blanks around it.
};

/// A program's places, by their names.
class ProgramMap {
 public:
  explicit ProgramMap(Assembly assembly) : assembly_(std::move(assembly)) {}

  const Assembly& assembly() const { return assembly_; }
  /// Nothing for an address behind the program.
  std::optional<Place> at(std::int32_t address) const;
  /// A label, LINE of the first file, or FILE:LINE; the first command there or below. Errors: a
  /// sentence.
  tl::expected<std::uint16_t, std::string> find(std::string_view name) const;
  /// User variables that its commands name, each once.
  std::vector<std::uint8_t> variables() const;
  /// "Loop+2", and the address where there is no label.
  std::string name_of(std::int32_t address) const;

 private:
  tl::expected<std::uint16_t, std::string> find_line(std::size_t file, std::size_t line) const;
  std::string label_at(std::size_t address) const;

  Assembly assembly_;
};

/// What only a simulated module tells.
struct Registers {
  std::int32_t accumulator = 0;
  std::int32_t x = 0;
  bool zero = true;                        ///< What was last calculated or read is 0.
  int compared = 0;                        ///< By the last comparison: -1 less, 0 equal, 1 greater.
  std::vector<std::string> errors{};       ///< Error flags: ETO, EAL, EDV, EPO, ESD.
  std::vector<std::uint16_t> returns{};    ///< Where subroutines return to, the outermost first.
  std::optional<std::uint16_t> resumes{};  ///< Within an interrupt: where the program goes on.
  bool operator==(const Registers&) const = default;
};

/// How a program stands.
struct Standing {
  std::string state{};                       ///< stopped, running, stepping or reset.
  std::optional<std::int32_t> address{};     ///< Of the next command, where the module tells it.
  std::optional<std::int32_t> last_error{};  ///< 0: none.
  std::string reason{};     ///< Why it stands: breakpoint, ended, steps, waits; empty: no step.
  std::uint64_t steps = 0;  ///< Commands executed since the last order.
  std::optional<Registers> registers{};
  std::optional<double> time_s{};  ///< Since the program began, in virtual time.
};

/// A user variable, or a parameter of a motor.
struct Watched {
  std::optional<std::uint8_t> motor{};  ///< Nothing: a user variable.
  std::string name{};                   ///< Of the parameter; a number, also of a variable.
  bool operator==(const Watched&) const = default;
};
/// "variable 5", "motor 0 actual_position".
std::string to_text(const Watched& watched);

struct Reading {
  Watched watched;
  tl::expected<std::int32_t, std::string> value;
};

struct DebugOrder {
  enum class Kind : std::uint8_t { none, step, back, restart, stop, look, read, quit };
  Kind kind = Kind::none;
  std::uint32_t steps = 0;  ///< To execute, or to go back, at most.
  std::string text{};       ///< To be printed at once, with its line ends.
  bool is_error = false;    ///< What was typed was not understood.
};

struct DebuggerOptions {
  bool is_simulated = false;     ///< Goes back, and has registers.
  std::uint32_t most_steps = 0;  ///< Of one `continue`.
  std::uint8_t motors = 1;
};

class Debugger {
 public:
  static constexpr std::size_t most_breakpoints = 100;
  static constexpr std::size_t most_watched = 20;
  static constexpr std::size_t longest_line = 200;  ///< Bytes, of what is typed.

  Debugger(Assembly assembly, DebuggerOptions options)
      : map_(std::move(assembly)), options_(options) {}

  const ProgramMap& map() const { return map_; }
  /// What is to be done by a line that was typed.
  DebugOrder say(std::string_view line);
  /// Ascending addresses.
  const std::vector<std::uint16_t>& breakpoints() const { return breakpoints_; }
  /// What is to be read now: after `read` all variables of the program, otherwise what is watched.
  std::vector<Watched> to_read(DebugOrder::Kind kind) const;
  /// After an order of any kind but none and quit: what is to be printed.
  std::string stands(DebugOrder::Kind kind, const Standing& now,
                     const std::vector<Reading>& readings);
  /// As it was told last.
  const Standing& standing() const { return standing_; }

 private:
  struct Command;
  static const std::vector<Command>& commands();
  using Words = std::vector<std::string_view>;

  DebugOrder step(const Words& words);
  DebugOrder go_on(const Words& words);
  DebugOrder back(const Words& words);
  DebugOrder list(const Words& words);
  DebugOrder add_breakpoint(const Words& words);
  DebugOrder remove_breakpoint(const Words& words);
  DebugOrder watch(const Words& words);
  DebugOrder unwatch(const Words& words);
  DebugOrder registers(const Words& words);
  DebugOrder help(const Words& words);

  std::string place_text() const;
  std::string changes(const Standing& before) const;
  std::string readings_text(const std::vector<Reading>& readings);

  ProgramMap map_;
  DebuggerOptions options_;
  std::vector<std::uint16_t> breakpoints_;
  std::vector<Watched> watched_;
  std::map<std::string, std::int32_t> known_;  ///< What was read last, by its text.
  Standing standing_;
  std::string repeated_;  ///< What an empty line means.
};

}  // namespace tmcl::program
