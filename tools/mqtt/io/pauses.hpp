/// How long to wait before a broker is tried again: longer each time, and not long after a
/// connection that has lasted.
#pragma once

#include <algorithm>
#include <chrono>

#include "tmcl/clock.hpp"

namespace tmclmqtt {

class Pauses {
 public:
  static constexpr tmcl::Duration shortest = std::chrono::milliseconds(500);
  static constexpr tmcl::Duration longest = std::chrono::seconds(15);

  /// After an attempt that has ended when it was so old.
  tmcl::Duration next(tmcl::Duration lasted) {
    if (lasted > longest) next_ = shortest;
    const auto pause = next_;
    next_ = std::min<tmcl::Duration>(2 * pause, longest);
    return pause;
  }

 private:
  tmcl::Duration next_ = shortest;
};

}  // namespace tmclmqtt
