/// A module that a test plays: just enough to tell a right answer from a wrong one.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "tmcl/parameter.hpp"
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
    return parameters_.try_emplace({motor, type}, start).first->second;
  }
  /// Called before each request is executed.
  std::function<void(FakeModule&, const Request&)> before;
  /// Requests that were executed.
  const std::vector<Request>& executed() const { return executed_; }

  Reply execute(const Request& request) {
    executed_.push_back(request);
    if (before) before(*this, request);
    Reply reply{default_host_address, address_, Status::ok, request.command, request.value};
    if (concerns_motor(request) && request.motor >= motors_) {
      reply.status = Status::invalid_value;
      return reply;
    }
    carry_out(request, reply);
    return reply;
  }

 private:
  static bool concerns_motor(const Request& request) {
    return static_cast<std::uint8_t>(request.command) <= static_cast<std::uint8_t>(Command::RSAP);
  }

  void carry_out(const Request& request, Reply& reply) {
    switch (request.command) {
      case Command::GAP: reply.value = parameter(request.motor, request.type); break;
      case Command::SAP: parameter(request.motor, request.type) = request.value; break;
      case Command::GGP: reply.value = 2'000'000 + request.type; break;
      case Command::MVP: arrive(request.motor, request.value); break;
      case Command::MST: parameter(request.motor, axis_parameter::actual_velocity) = 0; break;
      case Command::GET_FIRMWARE_VERSION: reply.value = to_value({3110, 1, 9}); break;
      default: break;
    }
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
  std::vector<Request> executed_;
};

}  // namespace tmcl::test
