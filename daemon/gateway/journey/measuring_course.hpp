/// What courses have in common that move an axis to find something out: nothing else moves it or
/// sets anything in it meanwhile, and it is as it was afterwards, whatever ends them.
///
///     leased ──▶ claimed ──▶ course ──▶ as it was ──▶ released
///                            └──stop, fault, caller gone──▶ stopped until it stands ──▶ as it was
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "gateway/authority/claim.hpp"
#include "gateway/authority/leases.hpp"
#include "gateway/axis/axis.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmcld {

class Gateway;

struct MeasuringCourse {
  std::vector<Claim> claims;
  std::optional<std::int32_t> lease;  ///< Its own.
};

/// `client` gets a lease for it, unless it has one, or could not lose it.
/// Errors: those of Leases::acquire() and of a claim.
GatewayAxis::Awaitable<std::shared_ptr<MeasuringCourse>> begin_course(
    Gateway& gateway, std::shared_ptr<GatewayAxis> axis, Client client, ClaimOwner claim_owner);
/// Waits for a while until the axis is in order: it is put there all the same. `before`: what is to
/// be given back; empty if nothing was changed, or the course has given it back.
boost::asio::awaitable<void> end_course(std::shared_ptr<Gateway> gateway,
                                        std::shared_ptr<GatewayAxis> axis,
                                        std::shared_ptr<MeasuringCourse> course,
                                        std::vector<tmcl::plan::Setting> before);

/// The axis may be measured. Errors: Errc::bad_argument for a model that is not known, an axis that
/// moves, and where there is neither a travel nor a soft limit.
GatewayAxis::Awaitable<void> check_course(GatewayAxis& axis, bool has_travel);
/// Where it may go: from where it stands, within its soft limits all the same; without a travel,
/// within them.
GatewayAxis::Awaitable<tmcl::ValueRange> travel_of(GatewayAxis& axis,
                                                   std::optional<tmcl::ValueRange> travel);

/// Nothing where there is no limit.
struct GreatestRates {
  std::optional<tmcl::PulsesPerSecond> velocity{};
  std::optional<tmcl::PulsesPerSecond2> acceleration{};
};
GatewayAxis::Awaitable<GreatestRates> greatest_rates(GatewayAxis& axis);

/// From here on they are given back, also by the next tmcld if this one is killed.
GatewayAxis::Awaitable<std::vector<tmcl::plan::Setting>> keep_settings(
    GatewayAxis& axis, std::vector<std::uint8_t> parameters);

}  // namespace tmcld
