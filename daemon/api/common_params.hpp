/// What each call can say of itself, besides its own parameters: the lease that it is made under,
/// and when it was made. The connection that has acquired a lease need not name it; calls that
/// read or stop need none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <boost/json/object.hpp>
#include <tl/expected.hpp>

#include "api/error.hpp"
#include "api/method.hpp"
#include "gateway/authority/leases.hpp"
#include "tmcl/api/lease.hpp"
#include "tmcl/clock.hpp"

namespace tmcld {

struct LeaseKey {
  std::int32_t lease = 0;
  std::int64_t epoch = 0;
};

/// Takes the lease out of the parameters; nothing if they name none.
/// Errors: one of the two is missing, or is no integer.
Result<std::optional<LeaseKey>> take_lease_key(const MethodInfo& method,
                                               boost::json::object& params);
/// The same of "sent_at_ms": when the call was sent, by this computer's CLOCK_MONOTONIC.
/// Errors: it is no integer.
Result<std::optional<tmcl::TimePoint>> take_sent_at(const MethodInfo& method,
                                                    boost::json::object& params);
/// Errors: lease_lost, stale_epoch.
Result<Lease> find_lease(const Leases& leases, LeaseKey key);

}  // namespace tmcld
