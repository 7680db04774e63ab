// SIO, GIO.
#include <algorithm>

#include "sim/module/module.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

// No document at hand says which is which.
constexpr std::int32_t shuts_down_when_high = 1;
constexpr std::int32_t shuts_down_when_low = 2;

// In tenths of a volt: too little for the drivers. Our choice.
constexpr std::int32_t brown_out_supply = 60;

}  // namespace

Answer Module::set_output(const Request& request) {
  return echo(request, io_.set(request.motor, request.type, request.value));
}

Answer Module::get_input(const Request& request) const {
  return reading(io_.get(request.motor, request.type));
}

bool Module::set_input(std::uint8_t port, bool high) {
  run_due();
  const bool exists = io_.set_input(port, high);
  run_application();
  return exists;
}

bool Module::set_analog(std::uint8_t port, std::int32_t value) {
  run_due();
  if (port != Io::supply_voltage_port) return io_.set_analog(port, value);
  if (value < 0 || value > Io::greatest_analog) return false;
  set_supply(value);
  return true;
}

void Module::set_supply(std::int32_t supply) {
  run_due();
  supply_returns_ = never;
  put_supply(supply);
  run_application();
}

void Module::brown_out(Duration duration) {
  run_due();
  if (supply_returns_ == never) supply_before_ = io_.supply();
  supply_returns_ = now_ + duration;
  put_supply(std::min(brown_out_supply, supply_before_));
  run_application();
}

void Module::end_brown_out() {
  if (now_ < supply_returns_) return;
  supply_returns_ = never;
  put_supply(supply_before_);
}

void Module::put_supply(std::int32_t supply) {
  io_.set_analog(Io::supply_voltage_port, supply);
  for (auto& axis : axes_) axis.set_supply(supply);
}

bool Module::set_shutdown_input(bool high) {
  if (!global_range(*model_, Globals::parameter_bank, gp::shutdown_pin_function)) return false;
  run_due();
  shutdown_input_ = high;
  run_application();
  return true;
}

// For as long as it is met, no motor goes on.
bool Module::shut_down() const {
  switch (globals_.value(gp::shutdown_pin_function)) {
    case shuts_down_when_high: return shutdown_input_ == true;
    case shuts_down_when_low: return shutdown_input_ == false;
    default: return false;
  }
}

}  // namespace tmcl::sim
