/// The modules this library knows by name.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace tmcl {

/// Modules of a family share a ramp generator and the meaning of their parameter numbers.
enum class Family : std::uint8_t { tmc429 };

struct Model {
  std::uint16_t number;   ///< What the firmware reports, such as 1110.
  std::string_view name;  ///< "TMCM-1110"
  std::uint8_t axes;
  Family family;
};

std::span<const Model> models();
/// Null for a model that is not known.
const Model* find_model(std::uint16_t number);
/// "TMCM-1110", "tmcm1110" and "1110" are one. Null for a model that is not known.
const Model* find_model(std::string_view name);

}  // namespace tmcl
