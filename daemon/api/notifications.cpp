#include "api/notifications.hpp"

#include <utility>

#include "api/views.hpp"

namespace tmcld {
namespace {

boost::json::object params_of(const GatewayEvent& event) {
  const auto view = view_of(event);
  auto params = api::to_json(view);
  if (!view.motors) params.erase(api::name_of<&api::Event::motors>());
  if (!view.cause) params.erase(api::name_of<&api::Event::cause>());
  if (!view.reason) params.erase(api::name_of<&api::Event::reason>());
  if (!view.unrestored) params.erase(api::name_of<&api::Event::unrestored>());
  return params;
}

}  // namespace

Notifications::Notifications(std::shared_ptr<Gateway> gateway, std::function<void()> on_pending)
    : gateway_(std::move(gateway)),
      on_pending_(std::move(on_pending)),
      subscriptions_(on_pending_) {
  event_listener_ = gateway_->on_event([this](const GatewayEvent& event) {
    if (event.kind == GatewayEvent::Kind::configuration_loaded) subscriptions_.follow(*gateway_);
    if (subscriptions_.size() > 0) push(api::Event::notification, params_of(event));
  });
}

void Notifications::push(std::string_view method, boost::json::object params) {
  if (queue_.size() >= max_unsent_notifications) {
    queue_.pop_front();
    ++dropped_;
  }
  queue_.push_back({std::string(method), std::move(params)});
  on_pending_();
}

std::optional<Notification> Notifications::take() {
  if (queue_.empty()) {
    auto state = subscriptions_.take_pending();
    if (!state) return std::nullopt;
    return Notification{std::string(api::NewState::notification), std::move(*state)};
  }
  auto oldest = std::move(queue_.front());
  queue_.pop_front();
  oldest.params["dropped"] = std::exchange(dropped_, 0);
  return oldest;
}

void Notifications::end() {
  gateway_->ignore_events(event_listener_);
  subscriptions_.clear();
}

}  // namespace tmcld
