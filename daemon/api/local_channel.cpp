#include "api/local_channel.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace tmcld {
namespace {

namespace client = tmcl::client;
namespace json = boost::json;

// How often it is looked whether a call is cancelled.
constexpr tmcl::Duration cancel_interval = std::chrono::milliseconds(20);
// For a call that was cancelled: a module in download mode is brought out of it.
constexpr tmcl::Duration time_to_end_call = std::chrono::seconds(1);

}  // namespace

client::Result<json::object> LocalChannel::call(std::string_view method, json::object params,
                                                const client::CallOptions& options) {
  const auto call = gateway_->begin(method, std::move(params));
  while (!call.has_ended()) {
    gateway_->listen(cancel_interval);
    if (options.meanwhile) {
      options.meanwhile();
    } else if (is_cancelled()) {
      return cut_short(call);
    }
  }
  return Result<json::object>(call.result()).map_error(client::without_nulls);
}

client::Result<json::object> LocalChannel::cut_short(const LocalCall& call) {
  gateway_->hang_up();
  const auto until = gateway_->now() + time_to_end_call;
  while (!call.has_ended() && gateway_->now() < until) gateway_->listen(cancel_interval);
  if (call.has_ended() && call.result()) return call.result().value();
  return tl::unexpected(client::Error{std::string(client::error_name::cancelled),
                                      client::ErrorKind::interrupted, tmcl::Outcome::unknown,
                                      "interrupted before it was done"});
}

client::Result<void> LocalChannel::check_buses() const {
  for (const auto& bus : gateway_->gateway().buses()) {
    if (bus->state() == GatewayBus::State::open) continue;
    return tl::unexpected(client::Error{std::string(name_of(tmcl::Errc::link_lost)),
                                        client::ErrorKind::failed, tmcl::Outcome::not_sent,
                                        bus->error()});
  }
  return {};
}

client::Result<void> LocalChannel::listen(tmcl::Duration at_most) {
  const auto until = gateway_->now() + at_most;
  while (!is_cancelled() && gateway_->now() < until) {
    if (gateway_->listen(std::min(until - gateway_->now(), cancel_interval))) break;
  }
  return check_buses();
}

void LocalChannel::run_for(tmcl::Duration duration) {
  const auto until = gateway_->now() + duration;
  while (!is_cancelled() && gateway_->now() < until)
    gateway_->listen(std::min(until - gateway_->now(), cancel_interval));
}

}  // namespace tmcld
