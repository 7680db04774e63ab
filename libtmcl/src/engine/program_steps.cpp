// Programs, command by command.
#include <algorithm>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/program_verbs.hpp"

namespace tmcl::verbs {
namespace {

using State = ProgramStatus::State;
using Reason = SteppedProgram::Reason;

/// As long as a tick of WAIT.
constexpr Duration look_interval = std::chrono::milliseconds(10);
/// Where a client that waits is to hear that this goes on.
constexpr int looks_between_news = 50;

/// What the module said, and what is decided on: read twice.
struct Stand {
  State state = State::stopped;
  std::int32_t next = 0;
};

Error refused_to_step(std::string message, std::string hint) {
  return {
      Errc::refused_by_module,      Outcome::refused, std::move(message), std::move(hint), {}, {},
      Status::command_not_available};
}

Request global_request(ModuleAddress module, std::uint8_t parameter) {
  return {module, Command::GGP, parameter, 0, 0};
}

Script<Result<std::int32_t>> next_address(ModuleAddress module) {
  return ask(global_request(module, global_parameter::program_counter), with_proof(Proof::twice));
}

Script<Result<Stand>> stand_of(ModuleAddress module) {
  const auto state = co_await must(ask(global_request(module, global_parameter::application_status),
                                       with_proof(Proof::followed)));
  const auto next = co_await must(next_address(module));
  co_return Stand{static_cast<State>(state & 3), next};
}

Script<Result<Stand>> stand_before(ModuleAddress module) {
  auto stand = co_await stand_of(module);
  if (!stand && stand.error().outcome == Outcome::refused) {
    co_return tl::unexpected(refused_to_step(
        fmt::format("module {} does not tell at which command its program is", number(module)),
        "it would be in global parameter 130; 'program.step' executes one command all the same"));
  }
  if (stand && stand->state == State::running) {
    co_return tl::unexpected(
        refused_to_step(fmt::format("a program is running on module {}", number(module)),
                        "stop it first; motors that it has started go on"));
  }
  co_return stand;
}

/// Nothing where the module does not let it be read.
Script<Result<std::optional<program::Instruction>>> line_at(ModuleAddress module,
                                                            std::int32_t address) {
  const Request request{module, Command::READ_TMCL_MEMORY, 0, 0, address};
  const auto answer = co_await exchange(request, with_proof(Proof::twice));
  if (answer) co_return program::line_of(answer->reply);
  if (answer.error().outcome == Outcome::refused) co_return std::optional<program::Instruction>();
  co_return tl::unexpected(answer.error());
}

/// All others end with another command behind them, soon or late.
bool jumps_to_itself(const program::Instruction& line, std::int32_t address) {
  switch (line.command) {
    case Command::JA:
    case Command::JC:
    case Command::CSUB:
    case Command::CALL:
    case Command::DJNZ:
    case Command::RST: return line.value == address;
    default: return false;
  }
}

/// Some modules may say that they are stopped between two steps. What ends a program is known.
Script<Result<bool>> has_program_ended(ModuleAddress module, std::int32_t from, bool tells_steps) {
  if (tells_steps) co_return true;
  const auto line = co_await must(line_at(module, from));
  co_return !line || line->command == Command::STOP || line->command == Command{};
}

class Steps {
 public:
  Steps(ModuleAddress module, StepOptions options)
      : module_(module), options_(std::move(options)) {}

  Script<Result<SteppedProgram>> run() {
    stand_ = co_await must(stand_before(module_));
    std::optional<Reason> reason;
    while (!reason) {
      if (!goes_on()) reason = Reason::cancelled;
      if (!reason) reason = co_await must(step());
    }
    const auto status = co_await must(program_status(module_));
    co_return SteppedProgram{*reason, steps_, status};
  }

 private:
  bool goes_on() const { return !options_.progress || options_.progress(steps_); }

  Script<Result<std::optional<Reason>>> step() {
    const auto from = stand_.next;
    co_await must(step_program(module_));
    ++steps_;
    const auto waited = co_await must(wait(from));
    if (waited) co_return waited;
    if (stand_.state == State::stopped) {
      const bool ended = co_await must(ends_here(from));
      if (ended) co_return std::optional(Reason::ended);
    }
    co_return reason_to_stand();
  }

  std::optional<Reason> reason_to_stand() const {
    const auto is_here = [&](std::uint16_t address) { return stand_.next == address; };
    if (std::ranges::any_of(options_.until, is_here)) return Reason::at_address;
    if (steps_ >= options_.most_steps) return Reason::steps;
    return std::nullopt;
  }

  Script<Result<bool>> ends_here(std::int32_t from) {
    const auto error = co_await must(unless_refused(
        ask(global_request(module_, global_parameter::tmcl_error), with_proof(Proof::followed))));
    if (error.value_or(0) != 0) co_return true;
    co_return co_await has_program_ended(module_, from, tells_steps_);
  }

  /// Until the command is over; why it is not.
  Script<Result<std::optional<Reason>>> wait(std::int32_t from) {
    const auto begin = co_await current_time();
    for (int looks = 1;; ++looks) {
      stand_ = co_await must(stand_of(module_));
      tells_steps_ = tells_steps_ || stand_.state == State::stepping;
      if (stand_.next != from || stand_.state == State::stopped) break;
      if (looks == 1) {
        const auto line = co_await must(line_at(module_, from));
        if (line && jumps_to_itself(*line, from)) break;
      }
      if (looks % looks_between_news == 0 && !goes_on()) co_return std::optional(Reason::cancelled);
      const auto now = co_await current_time();
      if (now - begin >= options_.longest_wait) co_return std::optional(Reason::waits);
      co_await pause(look_interval);
    }
    co_return std::optional<Reason>();
  }

  ModuleAddress module_;
  StepOptions options_;
  Stand stand_;
  std::uint32_t steps_ = 0;
  bool tells_steps_ = false;  ///< The module says `stepping` between two steps.
};

}  // namespace

Script<Result<SteppedProgram>> step_program_to(ModuleAddress module, StepOptions options) {
  Steps steps(module, std::move(options));
  co_return co_await steps.run();
}

}  // namespace tmcl::verbs
