/// A module held against its twin: tmcl/verification.hpp, on an axis of the gateway.
///
///     leased ──▶ claimed ──▶ course ──▶ as it was ──▶ released
///                            └──stop, fault, caller gone──▶ stopped until it stands ──▶ as it was
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "gateway/authority/leases.hpp"
#include "gateway/axis/axis.hpp"
#include "tmcl/verification.hpp"

namespace tmcld {

class Gateway;

struct VerificationRequest {
  /// From where the axis stands; within its soft limits all the same. Without it, within them.
  std::optional<tmcl::ValueRange> travel{};
  Client client{};  ///< Gets a lease for it, unless it has one, or could not lose it.
  Permit permit{};
  std::function<void(const std::string& what)> tell{};
};

/// No other client moves the axis meanwhile, or sets anything in it.
/// Errors: those of Leases::acquire(), of a claim, and of the course; Errc::bad_argument for a
/// model that is not known, and where there is neither a travel nor a soft limit.
GatewayAxis::Awaitable<tmcl::Verification> verify_axis(std::shared_ptr<Gateway> gateway,
                                                       std::shared_ptr<GatewayAxis> axis,
                                                       VerificationRequest request);

}  // namespace tmcld
