/// The requests of one client that are in progress: how many they may be, and which of them wait.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "api/method.hpp"
#include "api/request.hpp"

namespace tmcld {

/// How many requests of one client may be in progress. Stops have a number of their own, and so has
/// what keeps or gives back a lease, so that no flood of other calls keeps one out.
constexpr std::size_t max_requests_in_flight = 64;
/// While more of answers waits to be written, requests that only read wait, too: their answers are
/// the long ones, and no other client waits for them. What moves or stops something has its order.
constexpr std::size_t reads_wait_at_unsent_bytes = 128U * 1024U;

class RequestLanes {
 public:
  /// Counts a request until end(). False if there are as many already.
  bool begin(const MethodInfo& method);
  void end(const MethodInfo& method) { --in_flight(method); }
  bool are_empty() const { return count() == 0; }
  /// Of those that wait, too.
  std::size_t count() const;

  bool must_wait(const MethodInfo& method, std::size_t unsent_bytes) const;
  void wait(RpcRequest request) { waiting_.push_back(std::move(request)); }
  bool has_waiting() const { return !waiting_.empty(); }
  /// One that need not wait any more.
  std::optional<RpcRequest> next(std::size_t unsent_bytes);
  void forget_waiting() { waiting_.clear(); }

 private:
  /// Requests that do not keep each other out.
  enum class Lane : std::uint8_t { calls, stops, leases };
  static Lane lane_of(const MethodInfo& method);
  std::size_t& in_flight(const MethodInfo& method) {
    return in_flight_[static_cast<std::size_t>(lane_of(method))];
  }

  std::array<std::size_t, 3> in_flight_{};  ///< By lane.
  std::deque<RpcRequest> waiting_;          ///< In progress as far as clients are concerned.
};

}  // namespace tmcld
