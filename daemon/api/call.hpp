/// One call in progress: everything its method needs.
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <boost/json/value.hpp>

#include "api/method.hpp"
#include "api/peer.hpp"
#include "gateway/gateway.hpp"
#include "tmcl/api/system.hpp"

namespace tmcld {

/// Tells the client of a call how far that has come; may outlive the call.
class ProgressReporter {
 public:
  ProgressReporter(std::shared_ptr<Peer> peer, boost::json::value id)
      : peer_(std::move(peer)), id_(std::move(id)) {}

  template <class Progress>
  void operator()(const Progress& progress) const {
    boost::json::object params{{"id", id_}};
    for (auto& [name, value] : api::to_json(progress)) params.emplace(name, std::move(value));
    peer_->notify(api::progress_notification, std::move(params));
  }

 private:
  std::shared_ptr<Peer> peer_;
  boost::json::value id_;
};

struct Call {
  std::shared_ptr<Gateway> gateway;
  std::shared_ptr<Peer> peer;
  boost::json::value id;
  boost::json::object params;
  tmcl::TimePoint received;
  /// From when the request came in: a stop that came in behind it wins, whatever it waits for.
  Permit permit;
  Caller caller;
  const MethodInfo& method;
  /// What it does to a machine, as soon as that is known better than by its method.
  tmcl::Effect effect = method.effect;
  bool goes_on = false;     ///< What it has begun does not end with the answer.
  bool unattended = false;  ///< What it has begun moves motors, and no client owns that.
  /// The number of the lease that it names, if it does.
  std::optional<std::int32_t> lease{};
  std::shared_ptr<const void> typed{};

  /// The parameters; they live as long as the call.
  template <class T>
  const T& read() {
    auto read = std::make_shared<const T>(api::from_json<T>(params));
    typed = read;
    return *read;
  }

  /// The parameter "deadline_ms", if there is one, counted from when the request came in.
  template <class T>
  Deadline deadline(const T& given) const {
    if constexpr (requires { given.deadline_ms; }) {
      if (given.deadline_ms) return received + std::chrono::milliseconds(*given.deadline_ms);
    }
    return std::nullopt;
  }
  /// What is left of a timeout, counted the same, and never nothing: zero means that there is none.
  tmcl::Duration timeout_left(std::optional<std::int64_t> timeout_ms) const {
    const std::chrono::milliseconds timeout(timeout_ms.value_or(0));
    if (timeout == std::chrono::milliseconds{}) return {};
    const auto left = received + timeout - gateway->clock().now();
    return std::max(left, tmcl::Duration{1});
  }
  ProgressReporter progress_reporter() const { return {peer, id}; }
};

}  // namespace tmcld
