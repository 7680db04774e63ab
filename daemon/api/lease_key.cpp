#include "api/lease_key.hpp"

#include <algorithm>

#include "api/params.hpp"

namespace tmcld {
namespace {

using Key = tmcl::api::lease::OnLease;

bool is_about_leases(const MethodInfo& method) { return method.name.starts_with("lease."); }

}  // namespace

tl::expected<std::optional<LeaseKey>, RpcError> take_lease_key(const MethodInfo& method,
                                                               boost::json::object& params) {
  const auto names = [&](const api::Field& row) { return params.contains(row.name); };
  if (is_about_leases(method) || std::ranges::none_of(api::rows<Key>, names)) return std::nullopt;
  boost::json::object key;
  for (const auto& row : api::rows<Key>) {
    const auto found = params.find(row.name);
    if (found == params.end()) continue;
    key.emplace(row.name, found->value());
    params.erase(found);
  }
  auto described = method;
  described.params = api::rows<Key>;
  if (auto complaint = check_params(described, key)) return tl::unexpected(std::move(*complaint));
  const auto read = api::from_json<Key>(key);
  return LeaseKey{read.lease, read.epoch};
}

tl::expected<Lease, RpcError> find_lease(const Leases& leases, LeaseKey key) {
  auto found = leases.find(key.lease, key.epoch);
  if (found) return std::move(*found);
  const auto which = "lease " + std::to_string(key.lease);
  if (found.error() == NoLease::lost)
    return tl::unexpected(rpc_error(rpc_code::not_allowed, "lease_lost", which + " has ended",
                                    "lease.acquire gives a new one"));
  return tl::unexpected(rpc_error(rpc_code::not_allowed, "stale_epoch",
                                  which + " is not of epoch " + std::to_string(key.epoch),
                                  "it is another lease by now: lease.acquire gives a new one"));
}

}  // namespace tmcld
