#include "sim/module/io.hpp"

namespace tmcl::sim {

namespace {

constexpr std::uint16_t tmcm_351 = 351;
constexpr std::uint8_t analog_range_port = 8;

/// A bit for each of so many ports.
constexpr std::int32_t all_of(std::uint8_t ports) { return (1 << ports) - 1; }

}  // namespace

Io::Io(const Model& model) : model_(model.number), ports_(model.ports) {}

void Io::reset() {
  outputs_ = 0;
  pull_ups_ = 0;
}

tl::expected<std::int32_t, Status> Io::get(std::uint8_t bank, std::uint8_t port) const {
  switch (bank) {
    case input_bank: return get_input(port);
    case analog_bank: return get_analog(port);
    case output_bank: return get_output(port);
    default: return tl::unexpected(Status::invalid_value);
  }
}

tl::expected<std::int32_t, Status> Io::get_input(std::uint8_t port) const {
  if (port == all_ports) return static_cast<std::int32_t>(all_inputs());
  if (port >= ports_.digital_inputs) return tl::unexpected(Status::wrong_type);
  return input(port) ? 1 : 0;
}

tl::expected<std::int32_t, Status> Io::get_analog(std::uint8_t port) const {
  if (!has_analog(port)) return tl::unexpected(Status::wrong_type);
  return analog_[port];
}

tl::expected<std::int32_t, Status> Io::get_output(std::uint8_t port) const {
  if (port == all_ports) return static_cast<std::int32_t>(outputs_);
  if (port >= ports_.outputs) return tl::unexpected(Status::wrong_type);
  return static_cast<std::int32_t>(outputs_ >> port & 1U);
}

std::uint32_t Io::all_inputs() const {
  std::uint32_t all = 0;
  for (std::size_t port = 0; port < inputs(); ++port) all |= (input(port) ? 1U : 0U) << port;
  return all;
}

bool Io::has_analog(std::uint8_t port) const {
  if (port == supply_voltage_port || port == temperature_port) return true;
  return port < most_ports && (ports_.analog_inputs >> port & 1) != 0;
}

Status Io::set(std::uint8_t bank, std::uint8_t port, std::int32_t value) {
  switch (bank) {
    case input_bank: return set_inputs(port, value);
    case output_bank: return set_output(port, value);
    default: return Status::invalid_value;
  }
}

// By the manual of the TMCM-351 (V4.45, p. 37), and by what odemis' driver of the TMCM-3110 writes:
// bits for limit switches.
std::int32_t Io::greatest_pull_ups() const {
  if (model_ == tmcm_351) return all_of(ports_.digital_inputs);
  return model_ == 3110 || model_ == 6110 ? 3 : 1;
}

Status Io::set_inputs(std::uint8_t port, std::int32_t value) {
  // The range of the analogue input: what the converter reads is what the world outside drives.
  if (port == analog_range_port && model_ == tmcm_351)
    return value == 0 || value == 1 ? Status::ok : Status::invalid_value;
  if (port != 0) return Status::wrong_type;
  if (value < 0 || value > greatest_pull_ups()) return Status::invalid_value;
  const auto all = (value & 1) != 0 ? all_of(ports_.digital_inputs) : 0;
  pull_ups_ = static_cast<std::uint32_t>(model_ == tmcm_351 ? value : all);
  return Status::ok;
}

Status Io::set_output(std::uint8_t port, std::int32_t value) {
  const bool all = port == all_ports;
  if (!all && port >= ports_.outputs) return Status::wrong_type;
  const auto greatest = all ? all_of(ports_.outputs) : 1;
  if (value < 0 || value > greatest) return Status::invalid_value;
  const auto bits = static_cast<std::uint32_t>(value);
  outputs_ = all ? bits : (outputs_ & ~(1U << port)) | bits << port;
  return Status::ok;
}

bool Io::set_input(std::uint8_t port, bool high) {
  if (port >= ports_.digital_inputs) return false;
  driven_[port] = high;
  return true;
}

bool Io::set_analog(std::uint8_t port, std::int32_t value) {
  if (!has_analog(port) || value < 0 || value > greatest_analog) return false;
  analog_[port] = value;
  return true;
}

}  // namespace tmcl::sim
