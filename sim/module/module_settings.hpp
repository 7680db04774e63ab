/// In what a module is not like others of its model.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/module/delivered_firmware.hpp"

namespace tmcl::sim {

struct ModuleSettings {
  std::optional<FirmwareRelease> firmware{};  ///< Otherwise that of delivered_firmware().
};

}  // namespace tmcl::sim
