#include "api/beside_journeys.hpp"

#include "gateway/axis/axis.hpp"

namespace tmcld {
namespace {

std::optional<tmcl::Error> objection_by_journey(const GatewayBus& bus) {
  for (const auto by : {ClaimKind::path, ClaimKind::line, ClaimKind::mint, ClaimKind::jog,
                        ClaimKind::deadman_test, ClaimKind::verification, ClaimKind::tuning}) {
    if (bus.motors().claimed_by(by) == 0) continue;
    auto error =
        tmcl::not_sent(tmcl::Errc::axis_claimed,
                       "axes of this bus are led along a line or path, and that needs the bus",
                       "wait for its end: the module keeps what it records");
    error.bus = bus.name();
    return error;
  }
  return std::nullopt;
}

}  // namespace

RunOptions beside_journeys(const Call& call, const GatewayAxis& axis) {
  RunOptions options;
  options.permit = call.permit;
  options.objection = [bus = axis.bus().shared_from_this()] { return objection_by_journey(*bus); };
  return options;
}

}  // namespace tmcld
