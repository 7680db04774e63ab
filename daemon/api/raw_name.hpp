/// Motors by where they are: BUS:ADDRESS/MOTOR, and ADDRESS/MOTOR where there is one bus.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "api/lookup.hpp"

namespace tmcld {

/// Configured names have no '/'.
inline bool is_raw_name(std::string_view name) { return name.find('/') != std::string_view::npos; }

/// The axis that is configured there, or one of its own. `param`: where the client gave the name.
Result<std::shared_ptr<GatewayAxis>> find_raw_axis(Gateway& gateway, std::string_view param,
                                                   const std::string& name);

}  // namespace tmcld
