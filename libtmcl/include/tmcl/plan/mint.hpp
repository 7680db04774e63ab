/// Movements in the words of the Mint language, as application note AN00115-001 prints them:
///
///     SCALE = 1200          ' encoder counts of a user unit
///     SPEED = 250           ' user units, seconds
///     ACCEL = 1250
///     DECEL = 1250
///     MOVER = 200           ' loads a move by 200; MOVEA one to 200
///     GO                    ' starts it
///
/// One statement a line, or several with : between them. Case does not matter. A comment begins
/// with ' or REM. What follows a keyword says of which axes it speaks:
///
///     SPEED = 10            axis 0; SPEED = 10, 20: axes 0 and 1
///     SPEED.2 = 10          axis 2, also SPEED(2) = 10
///     SPEED[0,2] = 10, 20   axes 0 and 2
///     SPEED[0,2] = 10;      both the same; SPEED = 10; all axes
///     GO[0,2]               these together; GO: all axes that have a move loaded
///
/// The note shows the first form only; the others are as Mint's manuals have them. Nothing else of
/// the language is known here: no variables, expressions, tests or loops.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/plan/profile.hpp"
#include "tmcl/plan/text_bounds.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcl::plan::mint {

constexpr unsigned most_axes = 8;
/// A program with more is refused.
constexpr std::size_t most_statements = 100'000;

enum class Keyword : std::uint8_t { scale, speed, accel, decel, movea, mover, go };
/// "SPEED"
std::string_view name_of(Keyword keyword);

struct AxisValue {
  unsigned axis = 0;
  double value = 0;

  bool operator==(const AxisValue&) const = default;
};

struct Statement {
  Keyword keyword{};
  std::size_t line = 0;
  std::size_t column = 0;
  std::vector<AxisValue> values{};  ///< Of all but GO, in the order of the axes' list.
  std::vector<unsigned> axes{};     ///< Of GO; empty: all that have a move loaded.

  bool operator==(const Statement&) const = default;
};
using Program = std::vector<Statement>;

/// All that is wrong, by line, up to most_text_problems. SCALE, SPEED, ACCEL and DECEL are above 0,
/// all values finite.
tl::expected<Program, TextProblems> read(std::string_view text);

using Positions = std::array<double, most_axes>;

/// One axis from rest to rest.
struct Move {
  unsigned axis = 0;
  std::size_t line = 0;  ///< Of MOVEA or MOVER.
  double scale = 1;      ///< Counts of a user unit.
  double start = 0;      ///< In user units.
  double end = 0;
  std::optional<Profile> profile{};  ///< In user units and seconds; nothing if it stands there.

  double duration() const { return profile ? profile->total_time : 0; }
};

/// What one GO starts together.
struct Group {
  std::size_t line = 0;
  /// In seconds, if each GO comes when its axes stand still.
  double start_time = 0;
  double duration = 0;  ///< Until the last of its axes stands still.
  std::vector<Move> moves{};
};

struct DryRun {
  std::vector<Group> groups;
  Positions end{};  ///< In the user units of the end.
  double duration = 0;
  TextProblems warnings;  ///< Moves that no GO starts.
};

/// What the program would do to axes that begin at these counts. Where DECEL is not said, ACCEL
/// holds for both; where SCALE is not said, it is 1. A move too short for its SPEED is a triangle.
/// It is an error to start a move without SPEED or ACCEL, to load a second one before GO, or to
/// start what is not loaded.
tl::expected<DryRun, TextProblems> dry_run(const Program& program,
                                           const Positions& start_counts = {});

}  // namespace tmcl::plan::mint
