/// Text as a picture that a phone reads.
#pragma once

#include <string>

#include "screen.hpp"

namespace tmclctl {

/// Lines of two rows of modules each where the screen has UTF-8, of one row where not; with the
/// margin that readers need. Light modules are drawn, as on a dark terminal, unless the screen has
/// colours. Empty for a text that is too long (more than about 2,900 bytes).
std::string qr_code(const std::string& text, const Screen& screen);

}  // namespace tmclctl
