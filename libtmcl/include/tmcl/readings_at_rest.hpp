/// What is read of an axis as soon as its motor stands, as fast as the bus allows: what swings
/// behind it is in these readings (tmcl/plan/ring_down.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/script.hpp"

namespace tmcl {

struct ReadingAt {
  TimePoint at{};  ///< In the middle between the request and the reply.
  std::int32_t value = 0;
};

struct RestReadings {
  std::uint8_t parameter = 0;
  /// How long the move is expected to take from now on: it is not looked at much before that.
  Duration expected{};
  Duration timeout = std::chrono::seconds(10);  ///< For the arrival.
  Duration span = std::chrono::seconds(1);      ///< For so long it is read then.
  std::size_t most = 800;                       ///< Readings, spread over that; at least 1.
};

namespace verbs {

/// Waits until the axis stands at its target, and reads the parameter again and again. The times
/// are uneven, by up to half of what is between two readings, so that what swings faster than it is
/// read does not look like something slower.
/// Errors: Errc::deadline_passed where the axis does not arrive in time.
Script<Result<std::vector<ReadingAt>>> read_at_rest(AxisAddress axis, RestReadings wanted);

}  // namespace verbs
}  // namespace tmcl
