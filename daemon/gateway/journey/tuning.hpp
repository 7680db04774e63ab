/// What an axis of the gateway bears: tmcl/tuning.hpp, as a measuring course.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "gateway/authority/leases.hpp"
#include "gateway/axis/axis.hpp"
#include "tmcl/tuning.hpp"

namespace tmcld {

class Gateway;

struct TuningRequest {
  std::int32_t max_current = 0;  ///< Of parameter 6.
  /// From where the axis stands; within its soft limits all the same. Without it, within them.
  std::optional<tmcl::ValueRange> travel{};
  double margin = 0.2;
  std::optional<tmcl::LimitSwitch> by_switch{};  ///< Nothing: the encoder tells lost steps.
  Client client{};  ///< Gets a lease for it, unless it has one, or could not lose it.
  Permit permit{};
  std::function<void(const std::string& what)> tell{};
};

struct TunedAxis {
  tmcl::Tuning found;
  std::vector<tmcl::plan::Setting> before;  ///< What it had, and has.
};

/// No other client moves the axis meanwhile, or sets anything in it. An axis that has lost steps
/// has lost its reference.
/// Errors: those of Leases::acquire(), of a claim, and of verbs::tune(); Errc::not_permitted for an
/// axis with soft limits that has not found its reference; Errc::bad_argument for a model that is
/// not known, a current that it does not have, and where there is neither a travel nor a soft
/// limit.
GatewayAxis::Awaitable<TunedAxis> tune_axis(std::shared_ptr<Gateway> gateway,
                                            std::shared_ptr<GatewayAxis> axis,
                                            TuningRequest request);

}  // namespace tmcld
