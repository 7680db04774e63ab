#include "api/common_params.hpp"

#include <chrono>

#include "api/params.hpp"

namespace tmcld {
namespace {

bool is_about_leases(const MethodInfo& method) { return method.name.starts_with("lease."); }

/// Takes the parameters of this struct out of those of the call; nothing if there is none of them.
template <class Struct>
Result<std::optional<Struct>> take(const MethodInfo& method, boost::json::object& params) {
  boost::json::object taken;
  for (const auto& row : api::rows<Struct>) {
    const auto found = params.find(row.name);
    if (found == params.end()) continue;
    taken.emplace(row.name, found->value());
    params.erase(found);
  }
  if (taken.empty()) return std::nullopt;
  auto described = method;
  described.params = api::rows<Struct>;
  if (auto complaint = check_params(described, taken)) return tl::unexpected(std::move(*complaint));
  return api::from_json<Struct>(taken);
}

}  // namespace

Result<std::optional<LeaseKey>> take_lease_key(const MethodInfo& method,
                                               boost::json::object& params) {
  if (is_about_leases(method)) return std::nullopt;
  return take<tmcl::api::lease::OnLease>(method, params).map([](const auto& given) {
    return given ? std::optional(LeaseKey{given->lease, given->epoch}) : std::nullopt;
  });
}

Result<std::optional<tmcl::TimePoint>> take_sent_at(const MethodInfo& method,
                                                    boost::json::object& params) {
  return take<tmcl::api::axis::Sent>(method, params).map([](const auto& given) {
    const auto at = [&] { return tmcl::TimePoint(std::chrono::milliseconds(given->sent_at_ms)); };
    return given ? std::optional(at()) : std::nullopt;
  });
}

Result<Lease> find_lease(const Leases& leases, LeaseKey key) {
  const auto* found = leases.find(key.lease);
  if (found != nullptr && found->epoch == key.epoch) return *found;
  const auto which = "lease " + std::to_string(key.lease);
  if (found == nullptr)
    return tl::unexpected(
        not_now("lease_lost", which + " has ended", "lease.acquire gives a new one"));
  return tl::unexpected(not_now("stale_epoch",
                                which + " is not of epoch " + std::to_string(key.epoch),
                                "it is another lease by now: lease.acquire gives a new one"));
}

}  // namespace tmcld
