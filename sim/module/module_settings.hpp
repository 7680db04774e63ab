/// In what a module is not like others of its model.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/module/delivered_firmware.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/module_traits.hpp"

namespace tmcl::sim {

/// Whom the firmware is like where the manual and the vendor's example firmware do not agree.
enum class Behaviour : std::uint8_t {
  manual,  ///< What the manual says of a wrong value or type: it is refused.
  lite,    ///< TMCL-LITE: commands 242 and 255 with wrong codes do nothing, and say ok.
};

struct ModuleSettings {
  std::optional<FirmwareRelease> firmware{};  ///< Otherwise that of delivered_firmware().
  Behaviour behaviour = Behaviour::manual;
  ModuleTraits traits{};                ///< What concerns() other models has no effect.
  std::optional<Duration> to_answer{};  ///< Serial lines and USB; otherwise as those have it.
  std::optional<bool> data_logger{};    ///< Otherwise as has_data_logger() says of its family.
};

}  // namespace tmcl::sim
