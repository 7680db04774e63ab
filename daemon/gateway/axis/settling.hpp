/// Whether an axis that has arrived by its counter stands there by its encoder as well.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/script.hpp"

namespace tmcld {

/// So long it may take after the arrival, unless the client's own time is shorter.
constexpr tmcl::Duration time_to_settle = std::chrono::seconds(5);

/// What an encoder is to read; in its counts.
struct EncoderWindow {
  std::uint8_t parameter = 0;
  double wanted = 0;
  double width = 0;            ///< To either side.
  double counts_per_unit = 1;  ///< Of the axis; without a unit, counts are microsteps.
};

/// Until the encoder has been within the window for `steady`: gives nothing then; otherwise, if it
/// is not within it when `give_up` has come, how far off it is, in counts. Errors: those of the
/// exchanges.
tmcl::Script<tmcl::Result<std::optional<double>>> settle(tmcl::AxisAddress axis,
                                                         EncoderWindow window,
                                                         tmcl::Duration steady,
                                                         tmcl::TimePoint give_up);

}  // namespace tmcld
