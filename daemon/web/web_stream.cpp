#include "web/web_stream.hpp"

#include <utility>

#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>

namespace tmcld {

struct WebStream::Tls : boost::beast::ssl_stream<Tcp> {
  using boost::beast::ssl_stream<Tcp>::ssl_stream;
};

WebStream::WebStream(Tcp tcp) : tcp_(std::make_unique<Tcp>(std::move(tcp))) {}
WebStream::WebStream(WebStream&&) noexcept = default;
WebStream& WebStream::operator=(WebStream&&) noexcept = default;
WebStream::~WebStream() = default;

WebStream::Tcp& WebStream::next_layer() { return tls_ ? tls_->next_layer() : *tcp_; }

void WebStream::use_tls(boost::asio::ssl::context& context) {
  // Where there is no memory for it, neither is left.
  const auto tcp = std::exchange(tcp_, nullptr);
  tls_ = std::make_unique<Tls>(std::move(*tcp), context);
}

SSL* WebStream::native_handle() { return tls_ ? tls_->native_handle() : nullptr; }

void WebStream::handshake(HandshakeType type, boost::asio::const_buffer received, Done done) {
  // Beast 1.81 asks for a handler that can do without the second.
  tls_->async_handshake(type, received,
                        [done = std::move(done)](const error_code& error, std::size_t used = 0) {
                          done(error, used);
                        });
}

void WebStream::read_some(const Parts<boost::asio::mutable_buffer>& into, Done done) {
  if (tls_) return tls_->async_read_some(into, std::move(done));
  tcp_->async_read_some(into, std::move(done));
}

void WebStream::write_some(const Parts<boost::asio::const_buffer>& from, Done done) {
  if (tls_) return tls_->async_write_some(from, std::move(done));
  tcp_->async_write_some(from, std::move(done));
}

void WebStream::tear_down(boost::beast::role_type role,
                          std::function<void(const error_code&)> done) {
  using boost::beast::websocket::async_teardown;
  if (tls_) {
    async_teardown(role, static_cast<boost::beast::ssl_stream<Tcp>&>(*tls_), std::move(done));
  } else {
    async_teardown(role, *tcp_, std::move(done));
  }
}

}  // namespace tmcld
