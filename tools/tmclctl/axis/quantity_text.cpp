#include "quantity_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"

namespace tmclctl {
namespace {

constexpr int most_decimals = 12;

std::string without_zeros(std::string number) {
  if (number.find('.') == std::string::npos) return number;
  number.erase(number.find_last_not_of('0') + 1);
  if (number.ends_with('.')) number.pop_back();
  return number == "-0" ? "0" : number;
}

// As many as tell one of what is counted from the next.
int decimals_for(double one) {
  constexpr double slack = 1e-9;
  return std::clamp(static_cast<int>(std::ceil(-std::log10(one) - slack)), 0, most_decimals);
}

}  // namespace

std::optional<InUnit> in_unit(const std::optional<double>& number,
                              const std::optional<std::string>& unit) {
  if (!number || !unit) return std::nullopt;
  return InUnit{*number, *unit};
}

std::optional<InUnit> in_unit_a_second(const std::optional<double>& number,
                                       const std::optional<std::string>& unit) {
  return in_unit(number, unit ? std::optional(*unit + "/s") : std::nullopt);
}

std::string shown_number(double value, double counted) {
  // Nothing tells then what one is.
  if (counted == 0 || value == 0) return tmcl::plain_number(value, 10);
  return without_zeros(fmt::format("{:.{}f}", value, decimals_for(std::abs(value / counted))));
}

std::string shown(const InUnit& value, double counted) {
  return shown_number(value.value, counted) + ' ' + value.unit;
}

std::string shown(const std::optional<InUnit>& value, std::int64_t counted) {
  return value ? shown(*value, static_cast<double>(counted)) : fmt::format("{}", counted);
}

}  // namespace tmclctl
