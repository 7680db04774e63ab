#include "tmcl/ramp/generator.hpp"

#include <algorithm>

namespace tmcl::ramp {

bool RegisterInfo::takes(std::int64_t value) const {
  if (value < minimum || value > maximum) return false;
  return names.empty() || !names[static_cast<std::size_t>(value - minimum)].empty();
}

std::optional<std::int64_t> RegisterInfo::value_of(std::string_view value_name) const {
  const auto found = std::ranges::find(names, value_name);
  if (value_name.empty() || found == names.end()) return std::nullopt;
  return minimum + (found - names.begin());
}

std::string describe(const RegisterError& error) {
  const std::string name(error.info->name);
  if (error.reason == RegisterError::Reason::in_motion) {
    return name + " cannot be changed in motion";
  }
  return name + " is " + std::to_string(error.info->minimum) + ".." +
         std::to_string(error.info->maximum) + ", not " + std::to_string(error.value);
}

std::string describe(const Finding& finding,
                     const std::function<std::string(const Finding::Mention&)>& said) {
  constexpr std::string_view place = "{}";
  std::string message;
  auto rest = finding.text;
  for (const auto& mention : finding.mentions) {
    const auto at = rest.find(place);
    message += std::string(rest.substr(0, at)) + said(mention);
    rest.remove_prefix(at + place.size());
  }
  return message + std::string(rest);
}

std::string describe(const Finding& finding, std::span<const RegisterInfo> registers) {
  return describe(finding, [&](const Finding::Mention& mention) {
    const std::string name(registers[mention.index].name);
    if (mention.form == Finding::Form::name) return name;
    const auto value = std::to_string(mention.value);
    return mention.form == Finding::Form::value ? value : name + " " + value;
  });
}

std::optional<std::size_t> find_register(std::span<const RegisterInfo> registers,
                                         std::string_view name) {
  for (std::size_t i = 0; i < registers.size(); ++i) {
    if (registers[i].name == name) return i;
  }
  return std::nullopt;
}

}  // namespace tmcl::ramp
