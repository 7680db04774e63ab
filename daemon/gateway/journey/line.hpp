/// Several axes on a straight line: started together, watched until they have arrived together.
///
/// The speeds and accelerations of the axes' own settings are the limits. For the line some of them
/// are lowered, and set back when it is over. Nothing starts before every module has taken its
/// settings; if one does not go as planned, all are stopped.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <tl/expected.hpp>

#include "gateway/authority/claim.hpp"
#include "gateway/journey/planner.hpp"
#include "tmcl/plan/line.hpp"

namespace tmcld {

struct LineMember {
  std::shared_ptr<GatewayAxis> axis;
  tmcl::Microsteps target;
  // What it may do at most, beside the settings of its ramp.
  std::optional<tmcl::PulsesPerSecond> velocity{};
  std::optional<tmcl::PulsesPerSecond2> acceleration{};
};

struct LineOrder {
  std::vector<LineMember> members;           ///< Different axes, at least one.
  std::optional<tmcl::Duration> duration{};  ///< As short as possible if absent.
  Permit permit{};                           ///< Of the call.
  Deadline deadline{};
  Planner* planner = nullptr;  ///< Plans the line; must outlive it.
  /// Once all of them stand, or are given up; `fault`: name of what was wrong, or empty.
  std::function<void(std::string_view fault)> on_end = [](std::string_view) {};
};

struct StartedLine {
  tmcl::plan::Line plan;
  bool one_command = false;  ///< One MVP COORD started all of them.
  /// From how long the checks and the settings took on each bus.
  tmcl::Duration predicted_skew{};
  /// Between the first and the last start: the middle between a command and its answer counts.
  tmcl::Duration skew{};
  std::string journal_failure{};  ///< See DriveRun.
};

/// Returns when all of them have started, and goes on watching; a line that does not end as it
/// should is told by a GatewayEvent. Errors: nothing has started, or what had started has been
/// stopped.
boost::asio::awaitable<tmcl::Result<StartedLine>> start_line(LineOrder order);

}  // namespace tmcld
