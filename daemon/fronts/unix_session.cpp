#include "fronts/unix_session.hpp"

#include <array>
#include <utility>

#include <poll.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>

#include "async/spawn.hpp"
#include "fronts/peer_credentials.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;

constexpr std::size_t read_bytes = 16U * 1024U;
constexpr std::size_t write_batch_bytes = 64U * 1024U;

Session::Options options_of(UnixSession::Socket& socket, std::shared_ptr<Gateway> gateway,
                            std::shared_ptr<FrontShare> share, Session::Serves serves,
                            std::function<void()> on_closed) {
  auto credentials = credentials_of_peer(socket.native_handle());
  auto name =
      "process " + std::to_string(credentials.pid) + " of user " + std::to_string(credentials.uid);
  auto caller = [credentials = std::move(credentials), gateway] {
    return caller_with(credentials, gateway->access());
  };
  Session::Options options;
  options.share = std::move(share);
  options.caller = std::move(caller);
  options.name = std::move(name);
  options.serves = serves;
  options.on_closed = std::move(on_closed);
  return options;
}

}  // namespace

UnixSession::UnixSession(Socket socket, std::shared_ptr<Gateway> gateway, Serves serves,
                         std::function<void()> on_closed, std::shared_ptr<FrontShare> share)
    : Session(socket.get_executor(), gateway,
              options_of(socket, gateway, std::move(share), serves, std::move(on_closed))),
      socket_(std::move(socket)),
      lines_(max_line_bytes),
      input_ended_(executor()) {}

void UnixSession::start() {
  boost::system::error_code ignored;
  socket_.non_blocking(true, ignored);
  greet();
  const auto self = std::static_pointer_cast<UnixSession>(shared_from_this());
  const auto on_failure = [self](const auto& failure) { self->fail(failure); };
  spawn(executor(), write(self), on_failure);
  spawn(executor(), read(self), on_failure);
}

void UnixSession::disconnect() {
  boost::system::error_code ignored;
  socket_.close(ignored);
  input_ended_.notify();
}

// ---- input -------------------------------------------------------------------------------------

awaitable<void> UnixSession::read(std::shared_ptr<UnixSession> self) {
  std::array<char, read_bytes> bytes{};
  while (!self->is_closed()) {
    boost::system::error_code error;
    const auto count = co_await self->socket_.async_read_some(boost::asio::buffer(bytes),
                                                              redirect_error(use_awaitable, error));
    if (error) break;
    self->is_taking_input_ = true;
    self->lines_.push(std::string_view(bytes.data(), count),
                      [&](std::optional<std::string_view> line) { self->take(line); });
    self->is_taking_input_ = false;
    self->send_answers();
  }
  if (!self->is_closed()) co_await self->outlive_input();
}

// A client may end its input and still read: `echo '...' | nc -U SOCKET` does. Subscriptions keep
// such a connection open.
awaitable<void> UnixSession::outlive_input() {
  while (!is_closed() && !has_hung_up()) {
    if (subscriptions().size() == 0) finish();
    co_await input_ended_.wait_for(hang_up_check_interval);
  }
  close();
}

bool UnixSession::has_hung_up() {
  pollfd state{socket_.native_handle(), 0, 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

// ---- output ------------------------------------------------------------------------------------

void UnixSession::on_answer() {
  if (!is_taking_input_) send_answers();
}

/// The last answer that is awaited goes out at once, with those before it; otherwise there may be
/// more by the time the writer has its turn.
void UnixSession::send_answers() {
  if (is_closed()) return;
  if (!is_writing_ && !has_calls_in_flight()) write_now();
  if (has_output() || has_waiting_requests() || is_finishing()) wake_output();
}

void UnixSession::write_now() {
  batch_ += take_output();
  boost::system::error_code error;  // is met again when the rest is written
  batch_.erase(0, socket_.write_some(boost::asio::buffer(batch_), error));
}

std::string UnixSession::take_output() {
  std::string batch;
  while (batch.size() < write_batch_bytes) {
    const auto message = next_message();
    if (!message) break;
    (batch += *message) += '\n';
  }
  return batch;
}

awaitable<void> UnixSession::write(std::shared_ptr<UnixSession> self) {
  while (co_await self->wait_for_output()) {
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
