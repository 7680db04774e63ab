/// The lease that a call is made under: each call can name one, besides its own parameters. The
/// connection that has acquired it need not; whoever reads or stops needs none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <boost/json/object.hpp>
#include <tl/expected.hpp>

#include "api/method.hpp"
#include "api/rpc_error.hpp"
#include "gateway/leases.hpp"
#include "tmcl/api/lease.hpp"

namespace tmcld {

struct LeaseKey {
  std::int32_t lease = 0;
  std::int32_t epoch = 0;
};

/// Takes the lease out of the parameters; nothing if they name none.
/// Errors: one of the two is missing, or is no integer.
tl::expected<std::optional<LeaseKey>, RpcError> take_lease_key(const MethodInfo& method,
                                                               boost::json::object& params);
/// Errors: lease_lost, stale_epoch.
tl::expected<Lease, RpcError> find_lease(const Leases& leases, LeaseKey key);

}  // namespace tmcld
