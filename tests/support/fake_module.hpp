/// A module that a test plays: just enough to tell a right answer from a wrong one.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "tmcl/parameter.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/program.hpp"
#include "tmcl/verbs.hpp"
#include "tmcl/version.hpp"

namespace tmcl::test {

/// Every parameter of every motor holds another value, so that an answer given to the wrong
/// question shows.
class FakeModule {
 public:
  explicit FakeModule(std::uint8_t address, std::uint8_t motors = 3)
      : address_(address), motors_(motors) {}

  std::uint8_t address() const { return address_; }
  std::int32_t& parameter(std::uint8_t motor, std::uint8_t type) {
    const auto start =
        static_cast<std::int32_t>(1'000'000 + address_ * 10'000 + motor * 1'000 + type);
    // Nothing is wrong with its drivers.
    const bool has_faults = type == number_of("driver_status_flags");
    return parameters_.try_emplace({motor, type}, has_faults ? 0 : start).first->second;
  }
  /// Called before each request is executed.
  std::function<void(FakeModule&, const Request&)> before;
  /// Asked before each request is executed: the status with which the module refuses it.
  std::function<std::optional<Status>(const Request&)> refuse;
  /// The memory of programs; in download mode everything but END_DOWNLOAD is recorded there, also
  /// what no manual says so of.
  program::Program& program() { return program_; }
  /// What was recorded, in this order.
  const std::vector<Request>& recorded() const { return recorded_; }
  bool& downloading() { return downloading_; }
  std::int32_t& global(std::uint8_t type) {
    return globals_.try_emplace(type, 2'000'000 + type).first->second;
  }
  std::int32_t application_status = 0;
  /// Where the answer to command 135 has it.
  bool status_is_in_highest_byte = true;
  /// Carries a request out as if nobody had sent it.
  void execute_quietly(const Request& request) {
    Reply unread;
    carry_out(request, unread);
  }
  /// Asked before each request is executed: the reply, if the test gives it itself.
  std::function<std::optional<Reply>(const Request&)> play;
  /// Requests that were executed.
  const std::vector<Request>& executed() const { return executed_; }

  Reply execute(const Request& request) {
    if (before) before(*this, request);
    if (const auto played = play ? play(request) : std::nullopt) {
      executed_.push_back(request);
      return *played;
    }
    Reply reply{default_host_address, address_, Status::ok, request.command, request.value};
    if (downloading_ && request.command != Command::END_DOWNLOAD) {
      record(request);
      reply.status = Status::command_loaded;
      return reply;
    }
    executed_.push_back(request);
    if (concerns_motor(request) && request.motor >= motors_) {
      reply.status = Status::invalid_value;
      return reply;
    }
    if (const auto status = refuse ? refuse(request) : std::nullopt) {
      reply.status = *status;
      return reply;
    }
    carry_out(request, reply);
    return reply;
  }

 private:
  static bool concerns_motor(const Request& request) {
    const bool names_several =
        request.command == Command::MVP && request.type == 2 && request.motor >= 0x40;
    if (names_several) return false;
    return static_cast<std::uint8_t>(request.command) <= static_cast<std::uint8_t>(Command::RSAP);
  }

  void carry_out(const Request& request, Reply& reply) {
    switch (request.command) {
      case Command::GAP: reply.value = parameter(request.motor, request.type); break;
      case Command::SAP: parameter(request.motor, request.type) = request.value; break;
      case Command::GGP:
        // It has no tick timer, so nobody asks for that again and again.
        if (request.type == global_parameter::tick_timer && request.motor == 0)
          reply.status = Status::wrong_type;
        reply.value = global(request.type);
        if (request.type == global_parameter::application_status && request.motor == 0)
          reply.value = application_status;
        break;
      case Command::START_DOWNLOAD: begin_download(request.value); break;
      case Command::END_DOWNLOAD: downloading_ = false; break;
      case Command::GET_APPLICATION_STATUS:
        reply.value = status_is_in_highest_byte ? application_status << 24 | 7 : application_status;
        break;
      case Command::READ_TMCL_MEMORY: read_memory(request, reply); break;
      case Command::MVP:
        if (request.type == 0) arrive(request.motor, request.value);
        break;
      case Command::MST: parameter(request.motor, axis_parameter::actual_velocity) = 0; break;
      case Command::RFS: search(request.motor, request.type, reply); break;
      case Command::SCO: memory_[key(Command::SCO, request)] = request.value; break;
      case Command::CCO: capture(request); break;
      case Command::GCO: reply.value = remembered(Command::SCO, request); break;
      case Command::SIO: memory_[key(Command::SIO, request)] = request.value; break;
      case Command::GIO: reply.value = remembered(Command::SIO, request); break;
      case Command::GET_AP_MIN: reply.value = -request.type; break;
      case Command::GET_AP_MAX: reply.value = request.type; break;
      case Command::GET_INFO: inform(request.type, reply); break;
      case Command::GET_FIRMWARE_VERSION: reply.value = to_value({3110, 1, 9}); break;
      default: break;
    }
  }

  void begin_download(std::int32_t address) {
    downloading_ = true;
    next_line_ = static_cast<std::size_t>(address);
  }
  void record(const Request& request) {
    recorded_.push_back(request);
    if (next_line_ >= program_.size()) program_.resize(next_line_ + 1);
    program_[next_line_++] = {request.command, request.type, request.motor, request.value};
  }
  void read_memory(const Request& request, Reply& reply) const {
    const auto address = static_cast<std::size_t>(request.value);
    if (address >= program::most_commands) {
      reply.status = Status::maximum_exceeded;
      return;
    }
    reply = program::memory_reply(address < program_.size() ? program_[address]
                                                            : program::Instruction{});
  }

  static constexpr std::int32_t steps_of_a_search = 3;

  void search(std::uint8_t motor, std::uint8_t what, Reply& reply) {
    if (what == 0) searching_ = steps_of_a_search;
    if (what == 1) searching_ = 0;
    if (what != 2) return;
    reply.value = searching_ == 0 ? 0 : steps_of_a_search + 1 - searching_;
    if (searching_ > 0 && --searching_ == 0) arrive(motor, 0);
  }
  static Request key(Command command, const Request& request) {
    return {request.address, command, request.type, request.motor, 0};
  }
  void capture(const Request& request) {
    memory_[key(Command::SCO, request)] = parameter(request.motor, axis_parameter::actual_position);
  }
  std::int32_t remembered(Command command, const Request& request) {
    const auto other = 3'000'000 + request.motor * 1'000 + request.type;
    return memory_.try_emplace(key(command, request), other).first->second;
  }
  static void inform(std::uint8_t what, Reply& reply) {
    if (what >= 20) reply.status = Status::wrong_type;
    reply.value = 4'000'000 + what;
  }

  void arrive(std::uint8_t motor, std::int32_t target) {
    parameter(motor, axis_parameter::target_position) = target;
    parameter(motor, axis_parameter::actual_position) = target;
    parameter(motor, axis_parameter::actual_velocity) = 0;
    parameter(motor, axis_parameter::position_reached) = 1;
  }

  std::uint8_t address_;
  std::uint8_t motors_;
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::int32_t> parameters_;
  std::map<Request, std::int32_t> memory_;
  std::int32_t searching_ = 0;
  std::map<std::uint8_t, std::int32_t> globals_{{81, 0}};
  program::Program program_;
  std::vector<Request> recorded_;
  bool downloading_ = false;
  std::size_t next_line_ = 0;
  std::vector<Request> executed_;
};

}  // namespace tmcl::test
