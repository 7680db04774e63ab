/// Which curves of a movement are drawn: --show v,a,j.
#pragma once

#include <cstdint>
#include <vector>

#include "command_line/form.hpp"

namespace tmclctl::plot {

enum class Quantity : std::uint8_t { position, velocity, acceleration, jerk };

/// Each once; drawn from top to bottom.
using Shown = std::vector<Quantity>;
/// What is drawn if nothing was asked for: position above velocity.
Shown or_usual(Shown shown);

/// Its letter in --show and in tables: x, v, a or j.
char letter_of(Quantity quantity);
/// The option --show.
void add_show(Form& form, Shown& into);

}  // namespace tmclctl::plot
