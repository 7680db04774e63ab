/// A move one way of an axis that is tuned, and what is looked at meanwhile.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tmcl/readings_at_rest.hpp"
#include "verify/watched_axis.hpp"

namespace tmcl::verbs {

/// A move one way, and what was seen of it.
struct Passage {
  double deviation = 0;  ///< The greatest, in microsteps.
  std::optional<std::int32_t> load_value{};
  bool drifted = false;              ///< It held, but a part of a step is missing.
  std::vector<ReadingAt> at_rest{};  ///< Of the encoder, if it was to be listened to.
  std::string trouble{};             ///< Empty: it held, and the axis stands where it was sent.

  bool held() const { return trouble.empty(); }
};

/// What is looked at on the way, beside the encoder.
struct Lookout {
  Duration limit{};  ///< It has arrived by then.
  /// At this speed the load value is read, in the module's unit; nothing: it is not.
  std::optional<std::int32_t> load_value_from{};
  bool listens = false;  ///< To how its load swings when the motor stands.
};

/// Reads the load value, unless the axis is slower than that or speeds up.
Script<Result<void>> look_at_load(WatchedAxis& watched, Passage& passage, std::int32_t from);

}  // namespace tmcl::verbs
