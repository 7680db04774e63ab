/// Suggestions for names that do not exist.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tmcld {

/// "Did you mean 'x'?", or `otherwise` if no name is near enough. A word that is the beginning of
/// one name only is near to it, however much is missing. A word that is part of some names is near
/// to all of them: "Did you mean 'serial_address' or 'host_address'?"
std::string suggest(std::string_view word, std::span<const std::string_view> names,
                    std::string_view otherwise = {});

}  // namespace tmcld
