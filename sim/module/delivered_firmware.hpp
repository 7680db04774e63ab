/// The firmware that a module comes with.
#pragma once

#include <cstdint>

#include "tmcl/model.hpp"

namespace tmcl::sim {

/// A firmware version without its model: 1.09 is {1, 9}.
struct FirmwareRelease {
  std::uint8_t major = 0;  ///< 0..9: the text of command 136 has one digit for it ...
  std::uint8_t minor = 0;  ///< ... and two for this one.
  bool operator==(const FirmwareRelease&) const = default;
};

/// The newest that a public document has for this model; 1.01 where none was found.
FirmwareRelease delivered_firmware(const Model& model);

}  // namespace tmcl::sim
