#include "motion/path/gcode_feeds.hpp"

#include <cmath>

#include <fmt/format.h>

namespace tmcl::plan::path_file::gcode {
namespace {

constexpr int inverse_time = 930;
constexpr int of_a_turn = 950;
constexpr double seconds_of_a_minute = 60;

}  // namespace

void Feeds::set_mode(int code) {
  if (code == mode_) return;
  mode_ = code;
  linear_.reset();
  angular_.reset();
}

Part<void> Feeds::take(const std::optional<Word>& feed, double unit) {
  of_line_.reset();
  if (!feed) return {};
  const bool is_above = feed->value / seconds_of_a_minute > 0;
  // A movement with a feed that is wrong does not lack one.
  const double number = is_above ? feed->value : 1;
  if (mode_ == inverse_time) {
    of_line_ = number;
  } else {
    linear_ = number * unit;
    angular_ = number;
  }
  if (!is_above) return wrong(feed->column, "F must be above 0");
  return {};
}

Part<double> Feeds::of(int motion, std::size_t column, bool linear, double length) const {
  const auto missing = [&](std::string_view what) {
    return wrong(column, fmt::format("G{} needs {}", motion, what));
  };
  double feed = 0;
  if (mode_ == inverse_time) {
    if (!of_line_) return missing("F on its line, as G93 holds");
    feed = length * *of_line_;
  } else {
    const auto& said = linear ? linear_ : angular_;
    if (!said) return missing("F, which was not said yet");
    feed = *said;
    if (mode_ == of_a_turn && !(spindle_ > 0)) return missing("S above 0, as G95 holds");
    if (mode_ == of_a_turn) feed *= spindle_;
  }
  feed /= seconds_of_a_minute;
  if (feed > 0 && std::isfinite(feed)) return feed;
  return wrong(column, "the feed is beyond all numbers");
}

}  // namespace tmcl::plan::path_file::gcode
