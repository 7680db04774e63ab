#include "gateway/axis/settling.hpp"

#include <cmath>

#include "tmcl/verbs.hpp"

namespace tmcld {

tmcl::Script<tmcl::Result<std::optional<double>>> settle(tmcl::AxisAddress axis,
                                                         EncoderWindow window,
                                                         tmcl::Duration steady,
                                                         tmcl::TimePoint give_up) {
  constexpr tmcl::Duration between_looks = std::chrono::milliseconds(10);
  std::optional<tmcl::TimePoint> within_since;
  while (true) {
    const auto begin = co_await tmcl::current_time();
    const auto counted = co_await tmcl::must(tmcl::verbs::get(axis, window.parameter));
    const auto end = co_await tmcl::current_time();
    const double off = counted - window.wanted;
    // The encoder was read between the two times: within since the later, still there at the first.
    if (std::abs(off) > window.width) {
      within_since.reset();
    } else if (!within_since) {
      within_since = end;
    }
    if (within_since && begin >= *within_since + steady) co_return std::optional<double>();
    if (!within_since && end >= give_up) co_return std::optional<double>(off);
    co_await tmcl::pause(between_looks);
  }
}

}  // namespace tmcld
