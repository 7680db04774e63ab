/// The registers of a motor driver, as far as what they hold has an effect here: each field is the
/// setting of an axis parameter.
#pragma once

#include <cstdint>
#include <span>

#include "tmcl/parameter.hpp"

namespace tmcl::sim {

/// What a field counts in.
enum class FieldCode : std::uint8_t {
  plain,
  two_complement,
  halvings,  ///< MRES: 0 is 256 microsteps, 8 full steps.
  current,   ///< IRUN, IHOLD: 0 is 1/32 of what the parameter can be, 31 all of it.
};

struct DriverField {
  std::uint8_t address;
  std::uint8_t shift;
  std::uint8_t bits;
  std::uint8_t parameter;
  FieldCode code;
};

/// Empty for families whose driver is reached by another chip, or not described.
std::span<const DriverField> driver_fields(Family family);

/// `row` is that of the field's parameter.
std::int32_t value_in(const DriverField& field, std::uint32_t word, const ParameterInfo& row);
/// The word with the field set to what the parameter is.
std::uint32_t with_value(const DriverField& field, std::uint32_t word, std::int32_t value,
                         const ParameterInfo& row);

/// DRV_STATUS of a TMC5130 or TMC5160.
constexpr std::uint8_t driver_status_address = 0x6F;
struct DriverReading {
  std::int32_t load = 0;           ///< SG_RESULT
  std::int32_t current_scale = 0;  ///< CS_ACTUAL
  std::int32_t flags = 0;          ///< As in parameter 208.
};
std::int32_t driver_status(const DriverReading& reading);

}  // namespace tmcl::sim
