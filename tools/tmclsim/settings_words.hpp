/// What the command line and the bench file say of a module's firmware.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "sim/module/module_settings.hpp"

namespace tmclsim {

/// "1.09"; 0.00 to 9.99, as the text that command 136 answers with has it. Two digits behind the
/// point, because 1.9 could be 1.09 or 1.90.
std::optional<tmcl::sim::FirmwareRelease> parse_release(std::string_view text);
/// What is said of anything else, after the text.
inline constexpr std::string_view no_release =
    " is not a version: it is MAJOR.MINOR, 0.00 to 9.99, such as 1.09";

/// "manual" or "lite"; the error names the words and the nearest of them.
tl::expected<tmcl::sim::Behaviour, std::string> parse_behaviour(std::string_view word);

}  // namespace tmclsim
