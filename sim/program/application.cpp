#include "sim/program/application.hpp"

namespace tmcl::sim {
namespace {

constexpr std::uint8_t run_on = 0;
constexpr std::uint8_t run_from_address = 1;

std::uint16_t address_in(const Request& request) {
  return static_cast<std::uint16_t>(request.value);
}

}  // namespace

bool Application::is_control(Command command) {
  return (command >= Command::STOP_APPLICATION && command <= Command::GET_APPLICATION_STATUS) ||
         command == Command::BREAKPOINT;
}

Answer Application::execute(const Request& request, TimePoint now) {
  switch (request.command) {
    case Command::RUN_APPLICATION: return run(request, now);
    case Command::STEP_APPLICATION: return step(request, now);
    case Command::START_DOWNLOAD: return begin_download(request);
    case Command::END_DOWNLOAD: return end_download(request);
    case Command::READ_TMCL_MEMORY: return read(request);
    case Command::GET_APPLICATION_STATUS: return reading(state_and_address());
    case Command::BREAKPOINT: return set_breakpoint(request);
    case Command::STOP_APPLICATION: processor_.stop(); return echo(request);
    case Command::RESET_APPLICATION: processor_.reset(); return echo(request);
    default: return echo(request, Status::invalid_command);
  }
}

Answer Application::run(const Request& request, TimePoint now) {
  if (request.type != run_on && request.type != run_from_address)
    return echo(request, Status::wrong_type);
  if (request.type == run_from_address && !memory_.has(request.value))
    return echo(request, Status::invalid_value);
  if (in_download()) return echo(request, Status::command_not_available);
  if (request.type == run_on) {
    processor_.run(now);
  } else {
    processor_.run_from(address_in(request), now);
  }
  return echo(request);
}

Answer Application::step(const Request& request, TimePoint now) {
  if (in_download()) return echo(request, Status::command_not_available);
  processor_.step(now);
  return echo(request);
}

Answer Application::begin_download(const Request& request) {
  if (!memory_.has(request.value)) return echo(request, Status::invalid_value);
  if (protects(no_writing)) return echo(request, Status::write_protected);
  processor_.clear();
  memory_.begin_download(address_in(request));
  return echo(request);
}

// Ending what has not begun does no harm, and lets a host be sure.
Answer Application::end_download(const Request& request) {
  const bool failed = in_download() && !memory_.end_download();
  return echo(request, failed ? Status::download_not_possible : Status::ok);
}

Answer Application::record(const Request& request) {
  const bool recorded =
      memory_.record({request.command, request.type, request.motor, request.value});
  return echo(request, recorded ? Status::command_loaded : Status::maximum_exceeded);
}

Answer Application::read(const Request& request) const {
  if (!memory_.has(request.value)) return echo(request, Status::invalid_value);
  if (protects(no_reading)) return echo(request, Status::write_protected);
  Answer answer{Answer::Form::program_line};
  answer.line = *memory_.read(address_in(request));
  return answer;
}

Answer Application::set_breakpoint(const Request& request) {
  if (request.type > breakpoint_most) return echo(request, Status::wrong_type);
  if (request.type == breakpoint_most) return reading(static_cast<std::int32_t>(most_breakpoints));
  if (request.type == breakpoint_remove_all) {
    processor_.remove_breakpoints();
    return echo(request);
  }
  if (!memory_.has(request.value)) return echo(request, Status::invalid_value);
  if (request.type == breakpoint_remove) {
    processor_.remove_breakpoint(address_in(request));
    return echo(request);
  }
  const bool added = processor_.add_breakpoint(address_in(request));
  return echo(request, added ? Status::ok : Status::maximum_exceeded);
}

void Application::power_on(bool start, TimePoint now) {
  memory_.abandon_download();
  processor_.remove_breakpoints();
  processor_.clear();
  if (start) processor_.run(now);
}

bool Application::change_protection(std::int32_t from, std::int32_t to) {
  const bool erases = (from & no_reading) != 0 && (to & no_reading) == 0;
  if (erases) load({});
  return erases;
}

void Application::load(std::span<const program::Instruction> lines) {
  memory_.abandon_download();
  processor_.clear();
  memory_.assign(lines);
}

// Within a download, the address is that of the next line.
std::int32_t Application::state_and_address() const {
  constexpr int state_shift = 24;
  const auto address =
      in_download() ? static_cast<std::int32_t>(memory_.next_address()) : program_counter();
  return status() << state_shift | address;
}

Answer Application::execute_directly(const Request& request, TimePoint now) {
  return echo(request, processor_.execute_directly(
                           {request.command, request.type, request.motor, request.value}, now));
}

std::int32_t Application::last_error() const {
  const auto error = processor_.last_error();
  return error ? static_cast<std::int32_t>(*error) : 0;
}

}  // namespace tmcl::sim
