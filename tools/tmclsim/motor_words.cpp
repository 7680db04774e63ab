#include "motor_words.hpp"

#include <algorithm>

#include "number_text.hpp"

namespace tmclsim {

std::optional<tmcl::sim::DriverFault> parse_driver_fault(std::string_view word) {
  const auto* found = std::ranges::find(driver_fault_names, word);
  if (found == driver_fault_names.end()) return std::nullopt;
  return static_cast<tmcl::sim::DriverFault>(2U << (found - driver_fault_names.begin()));
}

std::optional<std::int32_t> parse_supply(std::string_view text) {
  if (text == usb_supply_word) return usb_supply;
  constexpr std::int32_t most = 1'000;
  const auto point = std::min(text.find('.'), text.size());
  const auto whole = parse_number<std::int32_t>(text.substr(0, point));
  const auto tenth =
      point == text.size() ? std::optional(0) : parse_number<std::int32_t>(text.substr(point + 1));
  if (!whole || *whole < 0 || *whole > most || !tenth || text.size() > point + 2)
    return std::nullopt;
  return *whole * 10 + *tenth;
}

}  // namespace tmclsim
