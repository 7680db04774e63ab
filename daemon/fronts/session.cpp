#include "fronts/session.hpp"

#include <array>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

#include "api/dispatch.hpp"
#include "async/spawn.hpp"
#include "fronts/peer_credentials.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;

constexpr std::size_t read_bytes = 16U * 1024U;
constexpr std::size_t write_batch_bytes = 64U * 1024U;
// How often a client that has ended its input is looked at, whether it still reads.
constexpr tmcl::Duration hang_up_check_interval = std::chrono::milliseconds(200);

static_assert(max_unsent_answers >= 2 * max_requests_in_flight);

boost::json::object hello(Session::Serves serves) {
  boost::json::object protocol;
  protocol["major"] = 1;
  protocol["minor"] = 1;
  boost::json::object params;
  params["protocol"] = std::move(protocol);
  params["daemon"] = TMCL_VERSION;
  if (serves == Session::Serves::stops) params["serves"] = "stops";
  return params;
}

std::string words_for(const Credentials& peer) {
  return "process " + std::to_string(peer.pid) + " of user " + std::to_string(peer.uid);
}

RpcError too_many_requests() {
  return rpc_error(rpc_code::overload, "too_many_requests",
                   "more than " + std::to_string(max_requests_in_flight) +
                       " requests of this connection are in progress",
                   "wait for answers before sending more");
}

RpcError too_many_clients() {
  return rpc_error(rpc_code::overload, "too_many_clients",
                   "tmcld has as many clients as it can serve: this connection takes stops only",
                   "end programs that do not need their connection any more; how many tmcld can "
                   "serve is limited by 'ulimit -n', too");
}

}  // namespace

Session::Session(Socket socket, std::shared_ptr<Gateway> gateway, Serves serves,
                 std::function<void()> on_closed)
    : socket_(std::move(socket)),
      gateway_(std::move(gateway)),
      serves_(serves),
      on_closed_(std::move(on_closed)),
      caller_(caller_with(credentials_of_peer(socket_.native_handle()), gateway_->access())),
      client_{gateway_->enter(), words_for(caller_.credentials)},
      lines_(max_line_bytes),
      output_(socket_.get_executor()),
      input_ended_(socket_.get_executor()),
      notifications_(gateway_, [this] { output_.notify(); }) {}

void Session::start() {
  boost::system::error_code ignored;
  socket_.non_blocking(true, ignored);
  outbox_.push_answer(notification_line("hello", hello(serves_)));
  const auto on_failure = [self = shared_from_this()](const auto& failure) { self->fail(failure); };
  spawn(socket_.get_executor(), write(shared_from_this()), on_failure);
  spawn(socket_.get_executor(), read(shared_from_this()), on_failure);
}

void Session::finish() {
  finishing_ = true;
  output_.notify();
}

void Session::close() {
  if (std::exchange(closed_, true)) return;
  notifications_.end();
  waiting_.clear();
  gateway_->leave(client_.number);
  boost::system::error_code ignored;
  socket_.close(ignored);
  output_.notify();
  input_ended_.notify();
  on_closed_();
}

void Session::fail(const std::exception_ptr& failure) {
  close();
  gateway_->log_failure("a client's connection, which was closed", failure);
}

// ---- input -------------------------------------------------------------------------------------

awaitable<void> Session::read(std::shared_ptr<Session> self) {
  std::array<char, read_bytes> bytes{};
  while (!self->closed_) {
    boost::system::error_code error;
    const auto count = co_await self->socket_.async_read_some(boost::asio::buffer(bytes),
                                                              redirect_error(use_awaitable, error));
    if (error) break;
    self->is_taking_input_ = true;
    self->lines_.push(std::string_view(bytes.data(), count),
                      [&](std::optional<std::string_view> line) { self->on_line(line); });
    self->is_taking_input_ = false;
    self->send_answers();
  }
  if (!self->closed_) co_await self->outlive_input();
}

// A client may end its input and still read: `echo '...' | nc -U SOCKET` does. Subscriptions keep
// such a connection open.
awaitable<void> Session::outlive_input() {
  while (!closed_ && !has_hung_up()) {
    if (subscriptions().size() == 0) finish();
    co_await input_ended_.wait_for(hang_up_check_interval);
  }
  close();
}

bool Session::has_hung_up() {
  pollfd state{socket_.native_handle(), 0, 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

void Session::on_line(std::optional<std::string_view> line) {
  if (closed_ || finishing_) return;
  if (!line) return answer(nullptr, tl::unexpected(line_too_long()));
  if (line->find_first_not_of(" \t\r") == std::string_view::npos) return;
  auto request = parse_request(*line);
  if (request) return begin(std::move(*request));
  answer(request.error().id, tl::unexpected(std::move(request.error().error)));
}

void Session::begin(RpcRequest request) {
  const bool stops = request.method->effect == tmcl::Effect::stops;
  if (serves_ == Serves::stops && !stops)
    return answer(request.id, tl::unexpected(too_many_clients()));
  auto& in_flight = stops ? stops_in_flight_ : calls_in_flight_;
  if (in_flight >= max_requests_in_flight) {
    return answer(request.id, tl::unexpected(too_many_requests()));
  }
  ++in_flight;
  if (must_wait(request)) return waiting_.push_back(std::move(request));
  start_serving(std::move(request));
}

bool Session::must_wait(const RpcRequest& request) const {
  if (request.method->effect != tmcl::Effect::reads) return false;
  return !waiting_.empty() || outbox_.answer_bytes() > reads_wait_at_unsent_bytes;
}

void Session::start_serving(RpcRequest request) {
  spawn(socket_.get_executor(), serve(shared_from_this(), std::move(request)),
        [self = shared_from_this()](const auto& failure) { self->fail(failure); });
}

void Session::start_waiting() {
  while (!waiting_.empty() && outbox_.answer_bytes() <= reads_wait_at_unsent_bytes) {
    auto request = std::move(waiting_.front());
    waiting_.pop_front();
    start_serving(std::move(request));
  }
}

awaitable<void> Session::serve(std::shared_ptr<Session> self, RpcRequest request) {
  const auto id = request.id;
  const auto effect = request.method->effect;
  auto result = co_await dispatch(self->gateway_, self, std::move(request));
  --(effect == tmcl::Effect::stops ? self->stops_in_flight_ : self->calls_in_flight_);
  self->answer(id, std::move(result), effect);
}

// ---- output ------------------------------------------------------------------------------------

void Session::answer(const boost::json::value& id, RpcResult result, tmcl::Effect effect) {
  if (closed_) return;
  if (!outbox_.push_answer(answer_line(id, std::move(result), effect))) {
    gateway_->log_often("cut off", LogLevel::warning,
                        "a client was cut off: it does not read its answers");
    return close();
  }
  if (!is_taking_input_) send_answers();
}

void Session::notify(std::string_view method, boost::json::object params) {
  if (!closed_) notifications_.push(method, std::move(params));
}

bool Session::has_output() const {
  return !batch_.empty() || !outbox_.empty() || notifications_.has_pending();
}

/// The last answer that is awaited goes out at once, with those before it; otherwise there may be
/// more by the time the writer has its turn.
void Session::send_answers() {
  if (closed_) return;
  if (!is_writing_ && !has_calls_in_flight()) write_now();
  if (has_output() || !waiting_.empty() || finishing_) output_.notify();
}

void Session::write_now() {
  batch_ += take_output();
  boost::system::error_code error;  // is met again by whoever writes the rest
  batch_.erase(0, socket_.write_some(boost::asio::buffer(batch_), error));
}

std::string Session::take_output() {
  std::string batch;
  const auto add = [&](const std::string& line) { (batch += line) += '\n'; };
  while (batch.size() < write_batch_bytes) {
    if (const auto line = outbox_.take_answer()) {
      add(*line);
    } else if (auto notification = notifications_.take()) {
      add(notification_line(notification->method, std::move(notification->params)));
    } else {
      break;
    }
  }
  return batch;
}

awaitable<void> Session::write(std::shared_ptr<Session> self) {
  while (!self->closed_) {
    self->start_waiting();
    if (!self->has_output()) {
      if (self->finishing_ && !self->has_calls_in_flight()) break;
      co_await self->output_.wait();
      continue;
    }
    if (self->batch_.empty()) self->batch_ = self->take_output();
    boost::system::error_code error;
    self->is_writing_ = true;
    co_await boost::asio::async_write(self->socket_, boost::asio::buffer(self->batch_),
                                      redirect_error(use_awaitable, error));
    self->is_writing_ = false;
    self->batch_.clear();
    if (error) break;
  }
  self->close();
}

}  // namespace tmcld
