/// A connection by TCP, behind TLS or not: what stands on it, HTTP and WebSocket, is compiled once
/// for both, which would take minutes more otherwise.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream_base.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace tmcld {

/// An asynchronous stream as Asio and Beast want one. What it calls back is called on the one
/// thread that runs its executor.
class WebStream {
 public:
  using Tcp = boost::beast::tcp_stream;
  using error_code = boost::system::error_code;
  using executor_type = Tcp::executor_type;
  using next_layer_type = Tcp;
  using HandshakeType = boost::asio::ssl::stream_base::handshake_type;
  /// How much was passed on.
  using Done = std::function<void(const error_code&, std::size_t)>;

  explicit WebStream(Tcp tcp);
  WebStream(WebStream&&) noexcept;
  WebStream& operator=(WebStream&&) noexcept;
  ~WebStream();

  /// False of one that was moved: nothing else can be done with it.
  explicit operator bool() const { return tcp_ != nullptr || tls_ != nullptr; }
  executor_type get_executor() { return next_layer().get_executor(); }
  Tcp& next_layer();
  const Tcp& next_layer() const { return const_cast<WebStream*>(this)->next_layer(); }

  /// Before anything is passed on; a handshake comes next.
  void use_tls(boost::asio::ssl::context& context);
  /// Null without TLS.
  SSL* native_handle();

  /// `received`: what has been read of it already. Completes with an error_code and how much of
  /// that was used.
  template <class Token>
  auto async_handshake(HandshakeType type, boost::asio::const_buffer received, Token&& token) {
    return boost::asio::async_initiate<Token, void(error_code, std::size_t)>(
        [this, type, received](auto handler) {
          handshake(type, received, erased(std::move(handler)));
        },
        token);
  }
  template <class Buffers, class Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(error_code, std::size_t)>(
        [this](auto handler, const Buffers& into) {
          read_some(Parts<boost::asio::mutable_buffer>(into), erased(std::move(handler)));
        },
        token, buffers);
  }
  template <class Buffers, class Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(error_code, std::size_t)>(
        [this](auto handler, const Buffers& from) {
          write_some(Parts<boost::asio::const_buffer>(from), erased(std::move(handler)));
        },
        token, buffers);
  }
  /// The end of a WebSocket: what is said below it so that the other end knows that, too.
  void tear_down(boost::beast::role_type role, std::function<void(const error_code&)> done);

 private:
  struct Tls;

  /// The first of them: more may go another time.
  template <class Buffer>
  struct Parts {
    static constexpr std::size_t most = 16;
    using value_type = Buffer;
    using const_iterator = const Buffer*;

    template <class Buffers>
    explicit Parts(const Buffers& buffers) {
      const auto end = boost::asio::buffer_sequence_end(buffers);
      for (auto it = boost::asio::buffer_sequence_begin(buffers); it != end && count < most; ++it)
        all[count++] = Buffer(*it);
    }
    const_iterator begin() const { return all.data(); }
    const_iterator end() const { return all.data() + count; }

    std::array<Buffer, most> all;
    std::size_t count = 0;
  };

  /// Handlers can only be moved, and functions only be copied.
  template <class Handler>
  static auto erased(Handler handler) {
    return [kept = std::make_shared<Handler>(std::move(handler))](const auto&... what) {
      std::move (*kept)(what...);
    };
  }

  void handshake(HandshakeType type, boost::asio::const_buffer received, Done done);
  void read_some(const Parts<boost::asio::mutable_buffer>& into, Done done);
  void write_some(const Parts<boost::asio::const_buffer>& from, Done done);

  template <class Handler>
  friend void async_teardown(boost::beast::role_type role, WebStream& stream, Handler&& handler) {
    stream.tear_down(role, erased(std::decay_t<Handler>(std::forward<Handler>(handler))));
  }

  std::unique_ptr<Tcp> tcp_;  ///< Null behind TLS.
  std::unique_ptr<Tls> tls_;
};

}  // namespace tmcld
