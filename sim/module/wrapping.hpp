/// What becomes of values out of range in firmware that does not check them.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {

struct Wrapped {
  std::int32_t kept;     ///< What GAP answers.
  std::int32_t written;  ///< What the chip gets.
  bool operator==(const Wrapped&) const = default;
};
/// Of a value that is out of the parameter's range; the row is one of a model with a TMC429: of
/// those it is known, by the vendor's example firmware TMCL-LITE for the TMCM-1110.
/// Nothing for a parameter that the example firmware does not have, or of which it does not tell
/// what the chip makes of it.
std::optional<Wrapped> wrapped(const ParameterInfo& info, std::int32_t value);
/// Whether GAP answers from the memory of the firmware, and not from the chip.
bool is_remembered(const ParameterInfo& info);

/// What the velocity register holds: -2047..2047. It could hold -2048, which no generator here has;
/// limited to 2047 as it is, that turns as -2047 does.
std::int32_t wrapped_velocity(std::int64_t value);

}  // namespace tmcl::sim
