#include "api/local_gateway.hpp"

#include <chrono>
#include <utility>

#include <unistd.h>

#include "api/dispatch.hpp"
#include "api/notifications.hpp"
#include "async/spawn.hpp"
#include "async/wait_until.hpp"
#include "gateway/ending.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;

constexpr tmcl::Duration listen_interval = 20ms;
// For calls that end because their bus is closed.
constexpr tmcl::Duration time_for_last_answers = 300ms;

}  // namespace

class LocalPeer final : public Peer {
 public:
  LocalPeer(std::shared_ptr<Gateway> gateway, std::shared_ptr<bool> news)
      : gateway_(std::move(gateway)),
        client_(gateway_->add_client("process " + std::to_string(::getpid()))),
        notifications_(gateway_, [news = std::move(news)] { *news = true; }),
        entry_(ClientList::enter(gateway_->clients(), client_.number, gateway_->clock().now(),
                                 [this] { return look(); })) {}

  void notify(std::string_view method, boost::json::object params) override {
    if (!is_gone_) notifications_.push(method, std::move(params));
  }
  bool is_gone() const override { return is_gone_; }
  Subscriptions& subscriptions() override { return notifications_.subscriptions(); }
  Client client() const override { return client_; }

  std::optional<Notification> take() { return notifications_.take(); }
  void leave() {
    if (std::exchange(is_gone_, true)) return;
    entry_.leave();
    notifications_.end();
    gateway_->remove_client(client_.number);
  }

  int calls_in_progress = 0;

 private:
  ConnectedClient look() const {
    ConnectedClient now{"process"};
    now.uid = ::geteuid();
    now.pid = ::getpid();
    now.role = caller().role;
    now.requests = static_cast<std::size_t>(calls_in_progress);
    return now;
  }

  std::shared_ptr<Gateway> gateway_;
  Client client_;
  Notifications notifications_;
  bool is_gone_ = false;
  ClientList::Entry entry_;
};

namespace {

using Ending = std::shared_ptr<std::optional<Result<boost::json::object>>>;

awaitable<void> carry_out(std::shared_ptr<Gateway> gateway, std::shared_ptr<LocalPeer> peer,
                          RpcRequest request, Ending ending, std::shared_ptr<bool> news) {
  ++peer->calls_in_progress;
  auto result = co_await dispatch(std::move(gateway), peer, std::move(request));
  --peer->calls_in_progress;
  ending->emplace(std::move(result));
  *news = true;
}

awaitable<void> end_with_calls(std::shared_ptr<Gateway> gateway, std::shared_ptr<LocalPeer> peer,
                               std::shared_ptr<bool> has_ended) {
  co_await end_gateway(std::move(gateway));
  co_await wait_until([&] { return peer->calls_in_progress == 0; }, time_for_last_answers);
  peer->leave();
  *has_ended = true;
}

}  // namespace

LocalGateway::LocalGateway(std::shared_ptr<boost::asio::io_context> context)
    : context_(std::move(context)), work_(context_->get_executor()) {}

LocalGateway::~LocalGateway() {
  peer_->leave();
  gateway_->close();
  gateway_->join();
  // A waiter for a bus learns now that it is closed, and ends: it keeps that bus alive.
  context_->poll();
}

tmcl::Result<std::unique_ptr<LocalGateway>> LocalGateway::open(
    const Config& config, GatewayOptions options,
    std::shared_ptr<boost::asio::io_context> context) {
  std::unique_ptr<LocalGateway> local(new LocalGateway(std::move(context)));
  local->gateway_ = Gateway::create(local->context_->get_executor(), config, std::move(options));
  local->peer_ = std::make_shared<LocalPeer>(local->gateway_, local->news_);
  for (const auto& bus : local->gateway_->buses()) {
    if (auto opened = bus->open_now(); !opened) return tl::unexpected(std::move(opened.error()));
  }
  local->gateway_->start();
  return local;
}

LocalCall LocalGateway::begin(std::string_view method, boost::json::object params) {
  LocalCall call;
  auto request = make_request(method, std::move(params));
  if (!request) {
    call.result_->emplace(tl::unexpected(std::move(request.error())));
    return call;
  }
  request->id = ++last_id_;
  spawn(context_->get_executor(),
        carry_out(gateway_, peer_, std::move(*request), call.result_, news_));
  return call;
}

Result<boost::json::object> LocalGateway::call(std::string_view method, boost::json::object params,
                                               const std::function<void()>& meanwhile) {
  const auto call = begin(method, std::move(params));
  while (!call.has_ended()) {
    listen(listen_interval);
    if (meanwhile) meanwhile();
  }
  return call.result();
}

tmcl::TimePoint LocalGateway::now() const { return tmcl::now(context_->get_executor()); }

bool LocalGateway::listen(tmcl::Duration at_most) {
  run_until_news(now() + at_most);
  return deliver();
}

void LocalGateway::run_until_news(tmcl::TimePoint limit) {
  if (auto time = tmcl::VirtualTime::of(*context_)) {
    if (!time->run_while_not([this] { return *news_; }, limit - time->now()))
      time->run_until(limit);
    return;
  }
  while (!*news_ && (context_->poll_one() > 0 || context_->run_one_until(limit) > 0)) {
    if (tmcl::RealClock().now() >= limit) break;
  }
}

bool LocalGateway::deliver() {
  const bool came = std::exchange(*news_, false);
  while (auto notification = peer_->take()) {
    if (on_notification_) on_notification_(notification->method, notification->params);
  }
  return came;
}

void LocalGateway::hang_up() {
  peer_->leave();
  peer_ = std::make_shared<LocalPeer>(gateway_, news_);
}

void LocalGateway::end() {
  is_ending_ = true;
  if (peer_->is_gone()) return;
  const auto has_ended = std::make_shared<bool>(false);
  spawn(context_->get_executor(), end_with_calls(gateway_, peer_, has_ended));
  while (!*has_ended) listen(listen_interval);
}

}  // namespace tmcld
