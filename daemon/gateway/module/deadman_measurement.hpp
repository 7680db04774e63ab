/// Whether a module stops its motors when it is sent nothing, and after how long: that it keeps a
/// time for it proves nothing.
///
/// An axis of it moves slowly, for a bounded way within its soft limits. Then nothing is sent to
/// the module, by anybody, for four times as long as it is set to: other calls wait, and a stop
/// ends the measurement. Where the axis has stopped meanwhile tells when, as its speed is known.
///
///     claimed ──▶ slow ──moves──▶ silent ──looked at──▶ stopped until it stands ──▶ speed set back
///                   │                │                        ▲
///                   └────────────────┴──stop, fault, caller gone
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "gateway/axis/axis.hpp"

namespace tmcld {

class Gateway;

struct DeadmanFinding {
  std::int32_t set_ms = 0;
  std::optional<std::int32_t> stops_after_ms{};  ///< Nothing: it does not.
  std::string reason{};                          ///< Why there is none.
  tmcl::Microsteps way{};                        ///< How far the axis has gone.
};

/// What the axis is about to do.
struct DeadmanPlan {
  std::int32_t set_ms = 0;
  tmcl::plan::Setting speed{};  ///< Of the movement.
  double pps = 0;               ///< The same; positive.
  tmcl::Microsteps from{};
  tmcl::Microsteps target{};  ///< It goes there at most.
  tmcl::Duration silence{};
};

/// Remembers what it finds. The axis stands when this ends, or is stopped until it does. `tell` is
/// called before anything moves.
/// Errors: also Errc::beyond_soft_limit where its soft limits leave no room; Errc::move_interrupted
/// if something else has stopped it; Errc::superseded_by_stop after a stop.
GatewayAxis::Awaitable<DeadmanFinding> measure_deadman(
    std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayAxis> axis, Permit permit,
    std::function<void(const DeadmanPlan& plan)> tell);

}  // namespace tmcld
