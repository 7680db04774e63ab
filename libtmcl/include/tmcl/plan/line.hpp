/// Several axes on a straight line: they start together and arrive together.
///
/// Every axis gets the part of one common speed and acceleration that its way is of the longest way
/// (application note AN-035), in register values. What rounding does to the times of arrival is
/// corrected: the slowest axis rules, and the others get those register values with which their
/// twins arrive when it does.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/clock.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/units.hpp"

namespace tmcl::plan {

constexpr std::size_t most_line_axes = 16;

/// How far one axis goes, and what it may do at most; in any units that go together.
struct Way {
  double distance = 0;
  double velocity = 0;      ///< Greater than 0.
  double acceleration = 0;  ///< Greater than 0.
};

/// The speed and the acceleration of the longest way with which no axis exceeds its limits. Each
/// axis gets the part of them that its way is of the longest.
struct SharedRamp {
  std::size_t longest = 0;
  double velocity = std::numeric_limits<double>::infinity();
  double acceleration = std::numeric_limits<double>::infinity();
};

/// Application note AN-035, equation 1. One way at least.
SharedRamp share_ramp(std::span<const Way> ways);

struct LineAxis {
  AxisTwin twin;  ///< Set as the axis is; stands where the line begins.
  Microsteps target;
  PulsesPerSecond velocity;       ///< What the axis may do at most; greater than 0.
  PulsesPerSecond2 acceleration;  ///< The same.
  std::size_t bus = 0;            ///< Index into ExchangeTimes; less than most_line_axes.
};

/// How long an exchange takes on each bus, from the request to the answer. Starts go out on all
/// buses at the same time, and on each bus one after the other. What is not there counts as 0,
/// as it is where one command starts them all.
using ExchangeTimes = std::vector<Duration>;

/// When a module acts: half-way between the request and the answer. After the first of them, in the
/// same order, if those on each of these buses start in that order.
std::vector<Duration> start_times(std::span<const std::size_t> buses,
                                  const ExchangeTimes& exchanges);

/// How an axis moves in a line.
struct AxisOfLine {
  std::vector<Setting> settings;  ///< To be written before, in this order; none if it stays.
  AxisTwin twin;                  ///< With these settings, on its way to the target.
  Duration start{};               ///< After the first of them.
  Duration arrival{};             ///< After the start of the first of them; 0 if it stays.
};

struct Line {
  std::vector<AxisOfLine> axes;    ///< As they were given.
  std::vector<std::size_t> order;  ///< Those that move, in the order in which to start them.
  Duration duration{};             ///< Until the last of them has arrived.
  Duration spread{};               ///< Between the first and the last arrival.
  /// How far off the line it gets at most, as a part of the longest way.
  double deviation = 0;
};

/// Speed and acceleration of one axis.
struct Pace {
  PulsesPerSecond velocity;
  PulsesPerSecond2 acceleration;
};

/// Why there is no such line, and of which axis that is the fault.
struct LineError {
  std::size_t axis = 0;
  std::string message;         ///< One sentence without a full stop, and without `pace`.
  std::optional<Pace> pace{};  ///< What it speaks of, if that is what its registers cannot say.
};

/// The dividers of a TMC429 are changed only where its registers would otherwise be too coarse for
/// the part of the line that the axis has.
/// Errors: no axis or more than most_line_axes; limits that are not greater than 0; an axis that
/// would have to be slower than its registers can say; one that does not arrive.
/// `duration`: how long it is to take; as short as possible if absent. Also an error: a shorter one
/// than that.
tl::expected<Line, LineError> plan_line(std::span<const LineAxis> axes,
                                        const ExchangeTimes& exchanges = {},
                                        std::optional<Duration> duration = std::nullopt);

}  // namespace tmcl::plan
