#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

std::string describe(const RegisterError& error) {
  const std::string name(error.info->name);
  if (error.reason == RegisterError::Reason::in_motion) {
    return name + " cannot be changed in motion";
  }
  return name + " is " + std::to_string(error.info->minimum) + ".." +
         std::to_string(error.info->maximum) + ", not " + std::to_string(error.value);
}

std::optional<std::size_t> find_register(std::span<const RegisterInfo> registers,
                                         std::string_view name) {
  for (std::size_t i = 0; i < registers.size(); ++i) {
    if (registers[i].name == name) return i;
  }
  return std::nullopt;
}

}  // namespace tmcl::ramp
