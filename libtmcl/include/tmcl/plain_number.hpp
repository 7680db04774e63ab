/// Numbers as people write them: 600000 and 0.5, where printf's %g writes 6e+05.
#pragma once

#include <string>

namespace tmcl {

/// The shortest that is read as the same number. It has an exponent only where the zeros had to be
/// counted: below 1e-6 and from 1e15 on.
std::string plain_number(double value);

/// Rounded to so many significant digits (1 to 17), or to a whole number if that has more; without
/// zeros at its end.
std::string plain_number(double value, int digits);

}  // namespace tmcl
