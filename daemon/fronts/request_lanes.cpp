#include "fronts/request_lanes.hpp"

#include <numeric>
#include <utility>

#include "tmcl/api/lease.hpp"

namespace tmcld {

RequestLanes::Lane RequestLanes::lane_of(const MethodInfo& method) {
  using tmcl::api::lease::Release;
  using tmcl::api::lease::Renew;
  if (method.name == Renew::method.name || method.name == Release::method.name) return Lane::leases;
  return method.effect == tmcl::Effect::stops ? Lane::stops : Lane::calls;
}

bool RequestLanes::begin(const MethodInfo& method) {
  auto& in_progress = in_flight(method);
  if (in_progress >= max_requests_in_flight) return false;
  ++in_progress;
  return true;
}

std::size_t RequestLanes::count() const {
  return std::accumulate(in_flight_.begin(), in_flight_.end(), std::size_t{0});
}

bool RequestLanes::must_wait(const MethodInfo& method, std::size_t unsent_bytes) const {
  if (method.effect != tmcl::Effect::reads) return false;
  return has_waiting() || unsent_bytes > reads_wait_at_unsent_bytes;
}

std::optional<RpcRequest> RequestLanes::next(std::size_t unsent_bytes) {
  if (waiting_.empty() || unsent_bytes > reads_wait_at_unsent_bytes) return std::nullopt;
  auto request = std::move(waiting_.front());
  waiting_.pop_front();
  return request;
}

}  // namespace tmcld
