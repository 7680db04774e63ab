/// Which curves of a movement are drawn: --show v,a,j.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "command_line/form.hpp"

namespace tmclctl::plot {

enum class Quantity : std::uint8_t { position, velocity, acceleration, jerk };

/// Each once; drawn from top to bottom.
using Shown = std::vector<Quantity>;
/// What is drawn if nothing was asked for: position above velocity.
Shown or_usual(Shown shown);

/// The columns of rows in CSV if nothing was asked for: all that a generator says of its motion.
Shown or_usual_columns(Shown shown);
Shown all_quantities();
/// x, v, a or j.
char letter_of(Quantity quantity);
/// "t,x,v,a" and the end of the line.
std::string csv_heading(const Shown& shown);
constexpr double most_csv_rows = 1e6;
/// The option --show.
void add_show(Form& form, Shown& into);

}  // namespace tmclctl::plot
