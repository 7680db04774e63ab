/// The inputs and outputs of one module that belong to no motor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tl/expected.hpp>

#include "tmcl/model.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

constexpr std::size_t most_ports = 16;  ///< Of each kind.

class Io {
 public:
  /// Banks, as the commands call them.
  static constexpr std::uint8_t input_bank = 0;
  static constexpr std::uint8_t analog_bank = 1;
  static constexpr std::uint8_t output_bank = 2;
  /// As a port: all of the bank at once, bit n for port n.
  static constexpr std::uint8_t all_ports = 255;
  /// Of the analogue bank, on top of the inputs.
  static constexpr std::uint8_t supply_voltage_port = 8;  ///< In 0.1 V.
  static constexpr std::uint8_t temperature_port = 9;     ///< In degrees centigrade.

  static constexpr std::int32_t greatest_analog = 65535;

  explicit Io(const Model& model);

  /// As after power-on. What the world outside does to the inputs stays.
  void reset();

  /// What GIO answers: wrong_type for an unknown port, invalid_value for an unknown bank.
  tl::expected<std::int32_t, Status> get(std::uint8_t bank, std::uint8_t port) const;
  /// What SIO answers: wrong_type for an unknown port, invalid_value for a bank that is no output
  /// or a value out of range. Bank 0, port 0 switches the pull-up resistors of the inputs; the
  /// TMCM-3110 and 6110 have a second bit there, for limit switches, which are never open here, and
  /// the TMCM-351 a bit for each input. Port 8 of that one sets the range of an analogue input.
  Status set(std::uint8_t bank, std::uint8_t port, std::int32_t value);

  /// The world outside drives an input; false, and nothing happens, if there is no such port. An
  /// input that was never driven is as the pull-up resistors make it.
  bool set_input(std::uint8_t port, bool high);
  /// The same. Values are what the converter reads, 0..65535, or those of the two special ports.
  bool set_analog(std::uint8_t port, std::int32_t value);

  /// Of the motors, in 0.1 V.
  std::int32_t supply() const { return analog_[supply_voltage_port]; }

  std::size_t inputs() const { return ports_.digital_inputs; }
  bool input(std::size_t port) const {
    return driven_.at(port).value_or((pull_ups_ >> port & 1U) != 0);
  }
  /// Bit n for port n.
  std::uint32_t outputs() const { return outputs_; }

 private:
  static constexpr std::size_t analog_ports = 10;  // with the special ones

  std::uint32_t all_inputs() const;
  tl::expected<std::int32_t, Status> get_input(std::uint8_t port) const;
  tl::expected<std::int32_t, Status> get_analog(std::uint8_t port) const;
  tl::expected<std::int32_t, Status> get_output(std::uint8_t port) const;
  bool has_analog(std::uint8_t port) const;
  Status set_inputs(std::uint8_t port, std::int32_t value);
  std::int32_t greatest_pull_ups() const;
  Status set_output(std::uint8_t port, std::int32_t value);

  std::uint16_t model_;
  Ports ports_;
  std::uint32_t pull_ups_ = 0;  ///< Bit n for input n.
  std::uint32_t outputs_ = 0;
  std::array<std::optional<bool>, most_ports> driven_{};
  // 24 V and 25 degrees.
  std::array<std::int32_t, analog_ports> analog_{0, 0, 0, 0, 0, 0, 0, 0, 240, 25};
};

}  // namespace tmcl::sim
