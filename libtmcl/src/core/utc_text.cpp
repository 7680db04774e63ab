#include "tmcl/utc_text.hpp"

#include <fmt/format.h>

namespace tmcl {

std::string to_text(UtcTime time, std::size_t decimals) {
  namespace chrono = std::chrono;
  const auto day = chrono::floor<chrono::days>(time);
  const chrono::year_month_day date(day);
  const chrono::hh_mm_ss<chrono::nanoseconds> clock(time - day);
  const auto fraction = fmt::format(".{:09}", clock.subseconds().count());
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}{}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     decimals == 0 ? "" : fraction.substr(0, 1 + decimals));
}

}  // namespace tmcl
