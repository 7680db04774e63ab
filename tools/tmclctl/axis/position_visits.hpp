/// The positions of a scan in the order in which an axis visits them, what became of each, and what
/// that says of the axis.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace tmclctl {

struct Visit {
  std::int32_t pass = 1;   ///< From 1.
  std::int32_t index = 0;  ///< Of the position, from 0.
  bool operator==(const Visit&) const = default;
};
/// Each pass goes from the first position to the last and, `both_ways`, back to the first. None is
/// visited twice without a movement in between.
std::vector<Visit> visits_of(std::int32_t steps, std::int32_t repeat, bool both_ways);

/// From which side a position was reached.
enum class Approach : std::uint8_t { none, up, down };
std::string_view name_of(Approach approach);

/// All numbers are in the unit of the axis, or in microsteps.
struct Reached {
  Visit visit;
  Approach approach = Approach::none;
  double target = 0;
  double reached = 0;
};

/// Of one position.
struct PositionStatistics {
  std::int32_t index = 0;
  double target = 0;
  std::size_t count = 0;
  double mean_deviation = 0;
  /// Between the two farthest from each other of those that were reached from one side; the greater
  /// one of both sides.
  double spread = 0;
  /// The mean of what was reached from above less the mean of what was from below; nothing unless
  /// it was reached from both.
  std::optional<double> backlash{};
};
struct ScanStatistics {
  std::vector<PositionStatistics> positions;  ///< Ascending by index.
  double repeatability = 0;                   ///< The greatest spread.
  std::optional<double> backlash{};           ///< The mean of all positions that have one.
};
ScanStatistics statistics_of(const std::vector<Reached>& visits);

// ---- The file

/// What stands in the row besides.
struct RowContext {
  std::string utc;
  std::int32_t target_microsteps = 0;
  std::int32_t position_microsteps = 0;
  std::optional<std::int32_t> encoder{};
};
/// The names of the columns, in a line.
std::string scan_columns(const std::string& unit);
std::string scan_row(const Reached& reached, const RowContext& context);

/// What a file has of a scan that was ended.
struct ScanFile {
  std::vector<Reached> visits;
  std::size_t bytes = 0;  ///< Up to the end of its last whole line; 0: it has no columns yet.
};
/// `about`: the comment that says which scan it is. Errors: it is of another one; a row cannot be
/// read.
tl::expected<ScanFile, std::string> read_scan(std::string_view text, const std::string& about,
                                              const std::string& columns,
                                              const std::vector<Visit>& visits);

}  // namespace tmclctl
