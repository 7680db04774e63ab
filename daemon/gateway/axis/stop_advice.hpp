/// What to do about an axis that stands short of its target.
#pragma once

#include <string_view>

namespace tmcld {

/// What has happened and what to try, by the name of a StopCause, in one sentence or two without
/// the last full stop. Empty for a name that is not known here.
std::string_view advice_on(std::string_view cause);

/// So a hint begins that says what the settings of an axis make of its moves.
constexpr std::string_view hint_of_settings = "with its settings, ";

}  // namespace tmcld
