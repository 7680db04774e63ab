// SIO, GIO.
#include "sim/module/module.hpp"

namespace tmcl::sim {

Answer Module::set_output(const Request& request) {
  return echo(request, io_.set(request.motor, request.type, request.value));
}

Answer Module::get_input(const Request& request) const {
  return reading(io_.get(request.motor, request.type));
}

bool Module::set_input(std::uint8_t port, bool high) {
  run_due();
  const bool exists = io_.set_input(port, high);
  application_.run_due(now_);
  return exists;
}

bool Module::set_analog(std::uint8_t port, std::int32_t value) {
  run_due();
  return io_.set_analog(port, value);
}

}  // namespace tmcl::sim
