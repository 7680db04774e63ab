/// What one client is told besides answers: events and progress, and the states that it watches.
/// Bounded, whatever the client does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>

#include "api/subscriptions.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

constexpr std::size_t max_unsent_notifications = 64;

struct Notification {
  std::string method;
  boost::json::object params;
};

class Notifications {
 public:
  /// `on_pending`: called whenever there is something to take.
  Notifications(std::shared_ptr<Gateway> gateway, std::function<void()> on_pending);
  Notifications(const Notifications&) = delete;
  Notifications& operator=(const Notifications&) = delete;
  ~Notifications() { end(); }

  /// The oldest gives way to the newest; the next one that is taken says how many did.
  void push(std::string_view method, boost::json::object params);
  Subscriptions& subscriptions() { return subscriptions_; }

  bool has_pending() const { return !queue_.empty() || subscriptions_.has_pending(); }
  std::optional<Notification> take();
  /// No events come any more, and nothing is watched.
  void end();

 private:
  std::shared_ptr<Gateway> gateway_;
  std::function<void()> on_pending_;
  std::uint64_t event_listener_;
  Subscriptions subscriptions_;
  std::deque<Notification> queue_;
  std::uint64_t dropped_ = 0;
};

}  // namespace tmcld
