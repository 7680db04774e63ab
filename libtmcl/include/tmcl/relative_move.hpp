/// A move by a distance, for callers with rules of their own about where it may end.
#pragma once

#include <functional>

#include "tmcl/address.hpp"
#include "tmcl/script.hpp"
#include "tmcl/units.hpp"

namespace tmcl::verbs {

/// Where a move from a place ends, or why it must not begin.
using Destination = std::function<Result<Microsteps>(Microsteps here)>;

/// As a movement is decided on: see Proof.
Script<Result<Microsteps>> proven_position(AxisAddress axis);
/// Reads where the axis is, asks where it is to go from there, and starts a move to that place;
/// gives it back. When the reading fails nothing has moved: Outcome::not_sent, whatever is known
/// about the reading.
Script<Result<Microsteps>> move_from_here(AxisAddress axis, Destination destination);

}  // namespace tmcl::verbs
