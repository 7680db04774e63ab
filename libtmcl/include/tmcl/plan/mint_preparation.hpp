/// From a Mint program and what is known of some axes to moves that they can make: everything that
/// is to be found out, and found wrong, before anything moves.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "tmcl/plan/mint.hpp"
#include "tmcl/plan/mint_drive.hpp"
#include "tmcl/plan/path_preparation.hpp"
#include "tmcl/quantity.hpp"

namespace tmcl::plan {

/// Objections: bad_program.
PathResult<mint::Program> read_mint(std::string_view text);

/// The numbers of the axes that the program moves.
std::set<unsigned> axes_moved_by(const mint::Program& program);

/// What is known of an axis, however it is reached.
struct MintAxis {
  unsigned number = 0;  ///< In the program.
  AxisUnits units;
  Microsteps position;
  double microsteps_per_count = 1;  ///< Of what SCALE counts; greater than 0.
  bool counts_encoder = false;      ///< SCALE counts what an encoder does, and not microsteps.
};

struct MintPlan {
  std::vector<MintDriveGroup> groups;  ///< Axes are counted as they were given.
  /// Moves that no GO starts, and what modules will do instead of what they cannot do; sentences
  /// without a full stop.
  std::vector<std::string> remarks;

  /// What it holds of memory, and a drive that it is given to.
  std::size_t bytes() const;
};

/// What the program does to axes that stand there. Objections: bad_program; missing_axis for a move
/// of an axis that is not there; unknown_units; out_of_range for a place or a ramp that its module
/// does not have; beyond_soft_limit.
PathResult<MintPlan> plan_mint(const mint::Program& program, const std::vector<MintAxis>& axes);

}  // namespace tmcl::plan
