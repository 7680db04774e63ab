/// An axis that is sent to one position after another, and what it has reached there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "axis/arrival_wait.hpp"
#include "axis/held_lease.hpp"
#include "axis/position_visits.hpp"
#include "axis/recording_csv.hpp"
#include "command_line/input_file.hpp"
#include "output/progress_line.hpp"
#include "tmcl/quantity.hpp"
#include "verbs.hpp"

namespace tmclctl {

constexpr int digits_of_targets = 12;
constexpr const char* encoder_of_scan = "encoder_position";

/// Where the axis is to go.
struct Span {
  double from = 0;
  double to = 0;
  std::string unit;  ///< As it was typed.

  tmcl::Quantity at(std::int32_t index, std::int32_t steps) const;
};
std::string text_of_target(const tmcl::Quantity& quantity);

/// What is known of the axis before it moves.
struct ScannedAxis {
  plot::Recording recording;
  tmcl::AxisUnits units;
  bool has_unit = false;
  bool has_encoder = false;

  std::string unit() const { return has_unit ? units.scale->unit : "microsteps"; }
};

class PositionScan {
 public:
  PositionScan(const verb::ScanPositions& verb, Span span, ScannedAxis axis, Context& context)
      : verb_(verb),
        span_(std::move(span)),
        axis_(std::move(axis)),
        context_(context),
        line_(context.output),
        visits_(visits_of(verb.steps, verb.repeat, verb.both_ways)) {}

  /// Before anything is sent to a module.
  Result<void> open_file();
  Result<void> run();
  const std::vector<Reached>& reached() const { return reached_; }
  const ScannedAxis& axis() const { return axis_; }

 private:
  Result<void> begin_file();
  Result<void> write(const std::string& text);
  Result<void> go_on();
  Result<void> visit(const Visit& visit);
  Result<tmcl::api::axis::StartedMove> move_to(const tmcl::Quantity& target);
  Result<void> wait(const tmcl::api::axis::StartedMove& move);
  /// Errors: it is lost.
  Result<void> keep_lease();
  /// Also: a signal came.
  Result<void> attend();
  Result<void> rest();
  Result<void> run_command(const Visit& visit, const Reached& reached);
  Result<void> note(const Reached& reached, RowContext row);
  Result<std::optional<tmcl::api::parameter::Value>> read_encoder();
  Reached reached_of(const Visit& visit, Approach approach, double target,
                     const AxisReading& reading,
                     const std::optional<tmcl::api::parameter::Value>& encoder) const;
  double target_of(const tmcl::Quantity& quantity, const tmcl::api::axis::StartedMove& move) const;
  Error stopped_meanwhile() const;
  /// What has ended the scan, with what became of it.
  Error ended_by(Error failure);

  const verb::ScanPositions& verb_;
  Span span_;
  ScannedAxis axis_;
  Context& context_;
  ProgressLine line_;
  std::vector<Visit> visits_;
  std::vector<Reached> reached_;
  HeldLease lease_;
  OutputFile file_;
  bool begins_file_ = true;
  bool was_sent_ = false;                   ///< The axis, somewhere.
  std::optional<std::uint64_t> last_stop_;  ///< When the scan began.
};

}  // namespace tmclctl
