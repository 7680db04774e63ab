/// One call in progress: everything its method needs.
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>

#include <boost/json/value.hpp>

#include "api/params.hpp"
#include "api/peer.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

struct Call {
  std::shared_ptr<Gateway> gateway;
  std::shared_ptr<Peer> peer;
  boost::json::value id;
  Params params;
  tmcl::TimePoint received;
  /// From when the request came in: a stop that came in behind it wins, whatever it waits for.
  Permit permit;

  /// The parameter "deadline_ms", counted from when the request came in.
  Deadline deadline() const {
    if (!params.has("deadline_ms")) return std::nullopt;
    return received + std::chrono::milliseconds(params.integer("deadline_ms"));
  }
  /// What is left of the parameter "timeout_ms", counted likewise, and never nothing: zero means
  /// that there is no timeout.
  tmcl::Duration timeout_left() const {
    const std::chrono::milliseconds timeout(params.integer_or("timeout_ms", 0));
    if (timeout == std::chrono::milliseconds{}) return {};
    const auto left = received + timeout - gateway->clock().now();
    return std::max(left, tmcl::Duration{1});
  }
};

}  // namespace tmcld
