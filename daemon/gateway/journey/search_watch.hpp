/// Keeps a reference search from going on where its switch never closes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "gateway/axis/axis.hpp"

namespace tmcld {

/// How far a motor has gone one way since it set out or turned. The module may give its counter
/// another value at any time: what the counter does and the speed does not explain is no way.
/// Does no I/O.
class SearchTravel {
 public:
  struct Look {
    tmcl::TimePoint at;
    std::int32_t position = 0;
    double speed = 0;  ///< In microsteps a second; negative: the other way.
    /// Else only its sign is.
    bool speed_is_known = true;
  };

  explicit SearchTravel(tmcl::TimePoint began) : began_(began) {}
  void note(const Look& look);
  /// In microsteps, since it set out or turned.
  double gone() const { return gone_; }

 private:
  double way_since(const Look& last, const Look& look) const;

  tmcl::TimePoint began_;
  std::optional<Look> last_;
  int direction_ = 0;
  double gone_ = 0;
};

/// Stops the search of this call when it has gone further one way than it may: axis_stopped, cause
/// search_limit. Ends with the search, or when the axis is moved for another call. Returns at once.
void watch_search(const std::shared_ptr<GatewayAxis>& axis, Permit permit);

}  // namespace tmcld
