#include "fronts/session.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "api/audit.hpp"
#include "api/dispatch.hpp"
#include "async/spawn.hpp"
#include "log/log.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;

static_assert(max_unsent_answers >= 3 * max_requests_in_flight);

/// A time of the daemon's own, which goes on by calls: a clock of its client's says nothing of it.
bool is_in_virtual_time(const boost::asio::any_io_executor& executor) {
  auto& context = boost::asio::query(executor, boost::asio::execution::context);
  return tmcl::VirtualTime::of(static_cast<boost::asio::io_context&>(context)).has_value();
}

boost::json::object hello(Session::Serves serves, bool is_in_virtual_time) {
  boost::json::object protocol;
  protocol["major"] = 1;
  protocol["minor"] = 1;
  boost::json::object params;
  params["protocol"] = std::move(protocol);
  params["daemon"] = TMCL_VERSION;
  if (serves == Session::Serves::stops) params["serves"] = "stops";
  if (is_in_virtual_time) params["time"] = "virtual";
  return params;
}

Error too_many_requests() {
  return failed("too_many_requests",
                "more than " + std::to_string(max_requests_in_flight) +
                    " requests of this connection are in progress",
                "wait for answers before sending more");
}

/// What a relay brings has been on its way, and the relay cannot tell how long it lay in the last
/// socket. A stop may have come by another one meanwhile.
std::optional<Error> objection_to_relayed(const RpcRequest& request, const Caller& caller,
                                          const FrontShare& share, tmcl::TimePoint now) {
  const auto effect = request.method->effect;
  const bool acts = effect == tmcl::Effect::moves || effect == tmcl::Effect::writes;
  if (!acts || caller.user.empty() || !request.sent_at) return std::nullopt;
  std::string why;
  if (*request.sent_at < share.stopped_all)
    why = "a stop of all axes has come in since it was sent";
  if (now - *request.sent_at > Gaps::longest_gap)
    why = "it was on its way from the relay for longer than a second";
  if (why.empty()) return std::nullopt;
  return not_now(name_of(tmcl::Errc::stale_request), std::move(why), std::string(stale_hint));
}

Error no_place_for_client() {
  return failed("too_many_clients",
                "tmcld has as many clients as it can serve: this connection takes stops only",
                "end programs that do not need their connection any more; how many tmcld can "
                "serve is limited by 'ulimit -n', too");
}

}  // namespace

Session::Session(const boost::asio::any_io_executor& executor, std::shared_ptr<Gateway> gateway,
                 Options options)
    : executor_(executor),
      gateway_(std::move(gateway)),
      share_(std::move(options.share)),
      serves_(options.serves),
      on_closed_(std::move(options.on_closed)),
      rights_(std::move(options.caller)),
      client_(gateway_->add_client(std::move(options.name))),
      came_{std::move(options.door), std::move(options.address), std::move(options.token)},
      output_(executor_),
      notifications_(gateway_, [this] { output_.notify(); }),
      entry_(ClientList::enter(gateway_->clients(), client_.number, gateway_->clock().now(),
                               [this] { return look(); })) {}

ConnectedClient Session::look() const {
  const auto who = caller();
  auto now = came_;
  // Who comes from the network is no process of this computer, as far as is known.
  const bool is_process = who.credentials.pid != 0;
  if (is_process) now.uid = who.credentials.uid;
  if (is_process) now.pid = who.credentials.pid;
  now.role = serves_ == Serves::stops ? Role::stop : who.role;
  now.relays = who.lends.has_value();
  now.requests = requests_.count();
  return now;
}

void Session::greet() {
  const auto greeting = hello(serves_, is_in_virtual_time(executor_));
  outbox_.push_answer(notification_line("hello", greeting));
}

void Session::finish() {
  finishing_ = true;
  output_.notify();
}

void Session::close() {
  if (std::exchange(closed_, true)) return;
  entry_.leave();
  notifications_.end();
  requests_.forget_waiting();
  std::exception_ptr failure;
  try {
    gateway_->remove_client(client_.number);
  } catch (...) {
    // What is to stop with its client, and does not.
    gateway_->stop_at_once();
    failure = std::current_exception();
  }
  disconnect();
  output_.notify();
  on_closed_();
  if (failure) std::rethrow_exception(failure);
}

std::optional<Error> Session::speak_for(RelayedUser user) {
  if (auto objection = rights_.speak_for(user)) return objection;
  client_ = gateway_->rename_client(client_.number, user.name + " through " + client_.name);
  return std::nullopt;
}

bool Session::has_lost_rights() {
  if (!rights_.have_shrunk()) return false;
  gateway_->log(LogLevel::warning,
                fmt::format("{} has the role '{}' by the new configuration, which is less than "
                            "before: its connection is closed",
                            client_.name, name_of(caller().role)));
  return true;
}

bool Session::holds_axes() const { return gateway_->is_holding(client_.number); }

void Session::fail(const std::exception_ptr& failure) {
  close();
  gateway_->log_failure("a client's connection, which was closed", failure);
}

// ---- input -------------------------------------------------------------------------------------

namespace {

/// Asked where there was no memory to read it. It may say so somewhere else than as its method.
bool may_ask_for_stop(std::string_view message) {
  return std::ranges::any_of(method_table(), [&](const MethodInfo& method) {
    return method.effect == tmcl::Effect::stops && message.find(method.name) != message.npos;
  });
}

}  // namespace

void Session::take(std::optional<std::string_view> message) {
  try {
    take_message(message);
  } catch (...) {
    if (message && may_ask_for_stop(*message)) gateway_->stop_in_need();
    throw;
  }
}

void Session::take_message(std::optional<std::string_view> message) {
  if (closed_ || finishing_) return;
  if (!message) return answer(nullptr, tl::unexpected(line_too_long()));
  if (message->find_first_not_of(" \t\r") == std::string_view::npos) return;
  auto [id, request] = parse_request(*message);
  const bool is_of_other_clock =
      !share_->clients_share_virtual_time && is_in_virtual_time(executor_);
  if (request && is_of_other_clock) request->sent_at.reset();
  if (request) return begin(std::move(*request));
  answer(id, tl::unexpected(std::move(request.error())));
}

void Session::begin(RpcRequest request) {
  const auto& method = *request.method;
  if (serves_ == Serves::stops && method.effect != tmcl::Effect::stops)
    return answer(request.id, tl::unexpected(no_place_for_client()));
  const auto now = gateway_->clock().now();
  if (method.name == tmcl::api::system::StopAll::method.name) share_->stopped_all = now;
  if (auto stale = objection_to_relayed(request, caller(), *share_, now))
    return answer(request.id, tl::unexpected(std::move(*stale)));
  if (!requests_.begin(method)) return answer(request.id, tl::unexpected(too_many_requests()));
  if (requests_.must_wait(method, outbox_.answer_bytes()))
    return requests_.wait(std::move(request));
  start_serving(std::move(request));
}

void Session::start_serving(RpcRequest request) {
  const bool stops = request.method->effect == tmcl::Effect::stops;
  spawn(executor_, serve(shared_from_this(), std::move(request)),
        [self = shared_from_this(), stops](const auto& failure) {
          if (stops) self->gateway_->stop_in_need();
          self->fail(failure);
        });
}

void Session::start_waiting() {
  while (auto request = requests_.next(outbox_.answer_bytes())) start_serving(std::move(*request));
}

awaitable<void> Session::serve(std::shared_ptr<Session> self, RpcRequest request) {
  const auto& method = *request.method;
  const auto text =
      is_logged(LogLevel::debug) ? words_of(method.name, request.params) : std::string();
  const auto id = request.id;
  const auto came = self->gateway_->clock().now();
  auto result = co_await dispatch(self->gateway_, self, std::move(request));
  if (method.effect == tmcl::Effect::stops)
    self->share_->stop_latency.note(self->gateway_->clock().now() - came);
  if (!text.empty()) self->log_call(text, result, self->gateway_->clock().now() - came);
  self->requests_.end(method);
  self->answer(id, result, method.effect);
}

void Session::log_call(const std::string& text, const Result<boost::json::object>& result,
                       tmcl::Duration took) {
  const std::chrono::duration<double, std::milli> milliseconds = took;
  gateway_->log(
      LogLevel::debug,
      fmt::format("client=\"{}\" {} outcome={} after {:.1f} ms", client_.name, text,
                  result ? "done" : "\"" + result.error().message + '"', milliseconds.count()));
}

// ---- output ------------------------------------------------------------------------------------

void Session::answer(const boost::json::value& id, const Result<boost::json::object>& result,
                     tmcl::Effect effect) {
  if (closed_) return;
  if (outbox_.push_answer(answer_line(id, result, effect))) return on_answer();
  gateway_->log_often("cut off", LogLevel::warning,
                      "a client was cut off: it does not read its answers");
  close();
}

void Session::notify(std::string_view method, boost::json::object params) {
  if (!closed_) notifications_.push(method, std::move(params));
}

std::optional<std::string> Session::next_message() {
  if (auto message = outbox_.take_answer()) return message;
  auto notification = notifications_.take();
  if (!notification) return std::nullopt;
  return notification_line(notification->method, notification->params);
}

awaitable<bool> Session::wait_for_output() {
  while (!closed_) {
    start_waiting();
    if (has_output()) co_return true;
    if (finishing_ && !has_calls_in_flight()) break;
    co_await output_.wait();
  }
  co_return false;
}

}  // namespace tmcld
