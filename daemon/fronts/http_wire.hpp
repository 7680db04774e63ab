/// What a client behind HTTP is reached by: a stream, from some moment on with a WebSocket on it.
/// Included by http_connection.cpp alone, since it takes long to compile.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <poll.h>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "fronts/http_message.hpp"
#include "web/web_stream.hpp"

namespace tmcld {

// A client has so long to take an answer.
constexpr auto time_for_body = std::chrono::seconds(10);
// What it still sends is read for so long, so that it reads why it was refused.
constexpr auto time_to_linger = std::chrono::seconds(2);
constexpr std::size_t linger_bytes = 16U * 1024U;

/// Move nothing of it while one of its coroutines runs.
class HttpWire {
 public:
  using WebSocket = boost::beast::websocket::stream<WebStream>;
  using Tcp = boost::asio::ip::tcp;
  using error_code = boost::system::error_code;
  template <class T>
  using Awaitable = boost::asio::awaitable<T>;

  HttpWire(WebStream stream, std::size_t most_bytes)
      : stream_(std::move(stream)), buffer_(most_bytes) {}

  /// Not once there is a WebSocket.
  WebStream& stream() { return stream_; }
  /// What has been read and not been used.
  boost::beast::flat_buffer& buffer() { return buffer_; }
  boost::beast::tcp_stream& lowest() {
    return websocket_ ? websocket_->next_layer().next_layer() : stream_.next_layer();
  }
  boost::asio::any_io_executor executor() { return lowest().get_executor(); }

  /// Puts one on the stream; its handshake comes next.
  void begin_websocket() { websocket_.emplace(std::move(stream_)); }
  /// Null before begin_websocket().
  WebSocket* websocket() { return websocket_ ? &*websocket_ : nullptr; }

  bool is_open() { return has_stream() && lowest().socket().is_open(); }
  void close() {
    if (!has_stream()) return;
    error_code ignored;
    lowest().socket().close(ignored);
  }
  /// Of poll(2): the client has ended its side, or the connection is broken; 0: neither.
  short hang_up_events() {
    pollfd state{lowest().socket().native_handle(), POLLRDHUP, 0};
    return ::poll(&state, 1, 0) > 0 ? state.revents : short{0};
  }

  /// False if the connection cannot be used any more.
  Awaitable<bool> send(Response& response) {
    const bool is_sent = co_await write(response);
    co_return is_sent&& response.keep_alive();
  }
  /// An answer without a body, before the one that a request gets.
  Awaitable<bool> send_interim(http::status status, unsigned version) {
    http::response<http::empty_body> response(status, version);
    const bool is_sent = co_await write(response);
    lowest().expires_never();
    co_return is_sent;
  }
  /// The last answer of the connection. It is given a value with a name: g++ 12 destroys one in
  /// braces behind co_await twice.
  Awaitable<void> refuse(const Error& refusal) {
    auto response = response_of(http_status_of(refusal), json_type, body_of(refusal), 11, false);
    const bool is_sent = co_await write(response);
    if (is_sent) co_await linger();
  }
  /// Reads on for a while: a connection that is closed with something unread loses the answer.
  Awaitable<void> linger() {
    error_code error;
    lowest().socket().shutdown(Tcp::socket::shutdown_send, error);
    lowest().expires_after(time_to_linger);
    std::string bytes(linger_bytes, '\0');
    while (!error) {
      co_await lowest().async_read_some(
          boost::asio::buffer(bytes),
          boost::asio::redirect_error(boost::asio::use_awaitable, error));
    }
  }

 private:
  template <class Message>
  Awaitable<bool> write(Message& message) {
    lowest().expires_after(time_for_body);
    error_code error;
    co_await http::async_write(stream_, message,
                               boost::asio::redirect_error(boost::asio::use_awaitable, error));
    co_return !error;
  }
  /// Where there was no memory for a WebSocket, the stream went with what was made of it.
  bool has_stream() const { return websocket_.has_value() || static_cast<bool>(stream_); }

  WebStream stream_;
  std::optional<WebSocket> websocket_;
  boost::beast::flat_buffer buffer_;
};

}  // namespace tmcld
