#include "safe_order.hpp"

#include <algorithm>

#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_choice.hpp"

namespace tmclctl {

using tmcl::plan::Setting;

Attempt<std::vector<Setting>> in_safe_order(std::vector<Setting> settings, const std::string& axis,
                                            Target& target) {
  constexpr auto pulse_divisor = tmcl::number_of("pulse_divisor");
  const auto divider = std::ranges::find(settings, pulse_divisor, &Setting::parameter);
  if (divider == settings.end()) return settings;
  return target.get(axis, std::to_string(pulse_divisor)).map([&](const ParameterValue& present) {
    return tmcl::plan::in_safe_order(std::move(settings), present.value);
  });
}

}  // namespace tmclctl
