/// What to do about an axis that stands short of its target.
#pragma once

#include <string_view>

namespace tmcld {

/// What has happened and what to try, by the name of a StopCause, in one sentence or two without
/// the last full stop. Empty for a name that is not known here.
std::string_view advice_on(std::string_view cause);

}  // namespace tmcld
