#include "web_socket.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "command_line/input_file.hpp"
#include "web/web_stream.hpp"

namespace tmclctl {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
namespace client = tmcl::client;
using asio::ip::tcp;
using boost::system::error_code;
using client::Error;
using client::ErrorKind;
using client::Result;
using tmcl::TimePoint;

constexpr std::uint16_t usual_port = 4143;
constexpr std::size_t longest_token = 1024;
constexpr auto cancel_poll_interval = std::chrono::milliseconds(50);

struct Url {
  bool is_secure = false;
  std::string host;
  std::uint16_t port = usual_port;
};

Error wrong(std::string message, std::string hint = {}) {
  return {"usage", ErrorKind::bad_request, tmcl::Outcome::not_sent, std::move(message),
          std::move(hint)};
}

Result<Url> parse_url(const std::string& text) {
  const auto bad = [&] {
    return tl::unexpected(wrong(fmt::format("'{}' is no URL of a tmcld", text),
                                "such as https://gateway.example:4143"));
  };
  Url url;
  std::string_view rest = text;
  url.is_secure = rest.starts_with("https://");
  if (!url.is_secure && !rest.starts_with("http://")) return bad();
  rest.remove_prefix(rest.find("//") + 2);
  if (rest.ends_with('/')) rest.remove_suffix(1);
  const auto bracket = rest.starts_with('[') ? rest.find(']') : 0;
  if (bracket == std::string_view::npos) return bad();
  const auto colon = rest.find(':', bracket);
  auto host = rest.substr(0, colon);
  if (bracket > 0) host = host.substr(1, bracket - 1);
  if (host.empty() || rest.find_first_of("/?#@ ") != std::string_view::npos) return bad();
  url.host = host;
  if (colon == std::string_view::npos) return url;
  const auto port = rest.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), url.port);
  if (error != std::errc{} || end != port.data() + port.size() || url.port == 0) return bad();
  return url;
}

Result<std::string> token_in(const std::string& path) {
  std::ifstream file(path);
  std::string token;
  if (!std::getline(file, token)) return tl::unexpected(wrong("cannot read a token from " + path));
  token.erase(token.find_last_not_of(" \t\r") + 1);
  const bool is_one = !token.empty() && token.size() <= longest_token &&
                      std::ranges::all_of(token, [](char c) { return c > ' ' && c < '\x7f'; });
  if (is_one) return token;
  return tl::unexpected(wrong("the first line of " + path + " is no token",
                              "'tmclctl token add' on the gateway makes one"));
}

/// Lets operations come to their end, each by a deadline.
class Runner {
 public:
  explicit Runner(std::function<bool()> cancelled) : cancelled_(std::move(cancelled)) {}

  asio::io_context& context() { return context_; }
  /// False when the deadline came first.
  Result<bool> run_until(const bool& is_done, TimePoint deadline) {
    while (!is_done) {
      if (cancelled_ && cancelled_()) {
        return tl::unexpected(Error{std::string(client::error_name::cancelled),
                                    ErrorKind::interrupted,
                                    tmcl::Outcome::unknown,
                                    "interrupted before tmcld answered",
                                    {}});
      }
      const auto left = deadline - clock_.now();
      if (left <= tmcl::Duration::zero()) return false;
      context_.restart();
      context_.run_one_for(std::min<tmcl::Duration>(left, cancel_poll_interval));
    }
    return true;
  }
  tmcl::TimePoint now() const { return clock_.now(); }

 private:
  asio::io_context context_{1};
  tmcl::RealClock clock_;
  std::function<bool()> cancelled_;
};

class WebSocket final : public client::LineChannel {
 public:
  WebSocket(std::string url, std::unique_ptr<Runner> runner)
      : url_(std::move(url)),
        runner_(std::move(runner)),
        stream_(beast::tcp_stream(runner_->context())) {}

  const std::string& name() const override { return url_; }
  Result<void> write_line(std::string line, TimePoint deadline) override;
  Result<std::optional<std::string>> read_line(TimePoint deadline) override;

  /// What `start` begins, which calls what it is given with an error_code.
  template <class Start>
  Result<error_code> run(TimePoint deadline, Start start) {
    bool is_done = false;
    error_code result;
    start([&](const error_code& error) {
      result = error;
      is_done = true;
    });
    const auto done = runner_->run_until(is_done, deadline);
    if (done && *done) return result;
    // What was begun refers to this function.
    tcp().close();
    runner_->context().restart();
    while (!is_done && runner_->context().run_one() != 0) {
    }
    if (!done) return tl::unexpected(done.error());
    return error_code(asio::error::timed_out);
  }
  websocket::stream<tmcld::WebStream>& stream() { return stream_; }
  beast::tcp_stream& tcp() { return stream_.next_layer().next_layer(); }
  Error lost(const std::string& why) const {
    return {std::string(client::error_name::lost), ErrorKind::failed, tmcl::Outcome::unknown,
            fmt::format("the connection to tmcld at {} broke: {}", url_, why),
            "Is tmcld still running there?"};
  }

 private:
  std::string url_;
  std::unique_ptr<Runner> runner_;
  websocket::stream<tmcld::WebStream> stream_;
  beast::flat_buffer received_;
  bool reads_ = false;
  bool has_read_ = false;
  error_code read_error_;
};

Result<void> WebSocket::write_line(std::string line, TimePoint deadline) {
  const auto sent = run(deadline, [&](auto end) {
    stream_.async_write(asio::buffer(line),
                        [end](const error_code& error, std::size_t) { end(error); });
  });
  if (!sent) return tl::unexpected(sent.error());
  if (*sent) return tl::unexpected(lost(sent->message()));
  return {};
}

Result<std::optional<std::string>> WebSocket::read_line(TimePoint deadline) {
  if (!std::exchange(reads_, true)) {
    stream_.async_read(received_, [this](const error_code& error, std::size_t) {
      read_error_ = error;
      has_read_ = true;
    });
  }
  const auto done = runner_->run_until(has_read_, deadline);
  if (!done) return tl::unexpected(done.error());
  if (!*done) return std::optional<std::string>{};
  reads_ = has_read_ = false;
  if (read_error_ == websocket::error::closed && !stream_.reason().reason.empty())
    return tl::unexpected(lost(std::string(stream_.reason().reason.c_str())));
  if (read_error_) return tl::unexpected(lost(read_error_.message()));
  auto line = beast::buffers_to_string(received_.data());
  received_.consume(received_.size());
  return std::optional(std::move(line));
}

// ---- opening ----

Error unreachable(const std::string& url, const std::string& why, std::string hint = {}) {
  return {std::string(client::error_name::unreachable), ErrorKind::failed, tmcl::Outcome::not_sent,
          fmt::format("cannot connect to tmcld at {}: {}", url, why), std::move(hint)};
}

std::string hint_for(const error_code& error) {
  if (error == asio::error::connection_refused)
    return "No program listens there: does tmcld run, and has its configuration [http] with this "
           "port?";
  if (error == asio::error::timed_out)
    return "Is the computer on, and does a firewall let this in?";
  if (error.category() == asio::error::get_netdb_category()) return "Is the name spelt right?";
  return {};
}

struct Handshake {
  const WebPlace& place;
  const Url& url;
  std::string token;
  TimePoint deadline;
};

Error refused(const WebPlace& place, const http::response<http::string_body>& answer) {
  switch (answer.result()) {
    case http::status::unauthorized:
      return unreachable(place.url,
                         place.token_file.empty()
                             ? "it wants a token"
                             : "it knows no such token as that in " + place.token_file,
                         "'tmclctl token add' on the gateway makes one, for --token-file");
    case http::status::forbidden:
      return unreachable(place.url, "it does not let this address in",
                         "[http] says whom it lets in without a token, and by which names");
    case http::status::service_unavailable:
      return unreachable(place.url, "it has too many clients", "End some of them");
    case http::status::bad_request:
      return unreachable(place.url, "it does not understand this",
                         "If it has a certificate, its URL begins with https://");
    default: break;
  }
  return unreachable(place.url, fmt::format("it answers {}", answer.result_int()),
                     "Is that a tmcld?");
}

Result<void> connect(WebSocket& socket, const Handshake& to) {
  tcp::resolver resolver(socket.stream().get_executor());
  error_code error;
  const auto endpoints = resolver.resolve(to.url.host, std::to_string(to.url.port), error);
  if (error) return tl::unexpected(unreachable(to.place.url, error.message(), hint_for(error)));
  const auto connected = socket.run(to.deadline, [&](auto end) {
    socket.tcp().async_connect(
        endpoints, [end](const error_code& failed, const tcp::endpoint&) { end(failed); });
  });
  if (!connected) return tl::unexpected(connected.error());
  if (*connected)
    return tl::unexpected(unreachable(to.place.url, connected->message(), hint_for(*connected)));
  socket.tcp().socket().set_option(tcp::no_delay(true), error);
  return {};
}

Result<void> upgrade(WebSocket& socket, const Handshake& to) {
  auto& stream = socket.stream();
  stream.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    if (!to.token.empty()) request.set(http::field::authorization, "Bearer " + to.token);
  }));
  stream.read_message_max(client::max_line_bytes);
  http::response<http::string_body> answer;
  const bool is_v6 = to.url.host.find(':') != std::string::npos;
  const auto host =
      fmt::format(fmt::runtime(is_v6 ? "[{}]:{}" : "{}:{}"), to.url.host, to.url.port);
  const auto upgraded =
      socket.run(to.deadline, [&](auto end) { stream.async_handshake(answer, host, "/ws", end); });
  if (!upgraded) return tl::unexpected(upgraded.error());
  if (*upgraded == websocket::error::upgrade_declined)
    return tl::unexpected(refused(to.place, answer));
  if (*upgraded) {
    return tl::unexpected(
        unreachable(to.place.url, upgraded->message(),
                    to.url.is_secure ? "Is that a tmcld?"
                                     : "If it has a certificate, its URL begins with https://"));
  }
  return {};
}

std::string hint_for_certificate(long verdict, const WebPlace& place) {
  switch (verdict) {
    case X509_V_OK: return "If it has no certificate, its URL begins with http://";
    case X509_V_ERR_CERT_HAS_EXPIRED:
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return "Its certificate is valid at another time: make a new one, or set the clock";
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return "Its certificate is for another name: use that in the URL";
    default: break;
  }
  return place.ca_file.empty() ? "--ca FILE names the certificate that vouches for it"
                               : "It is not vouched for by " + place.ca_file;
}

/// OpenSSL compares by itself, and so can tell what is wrong.
void expect_name(SSL* tls, const std::string& host) {
  error_code no_address;
  asio::ip::make_address(host, no_address);
  if (!no_address) {
    X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls), host.c_str());
    return;
  }
  SSL_set1_host(tls, host.c_str());
  SSL_set_tlsext_host_name(tls, host.c_str());
}

Result<void> secure(WebSocket& socket, asio::ssl::context& context, const Handshake& to) {
  if (!to.url.is_secure) return {};
  auto& stream = socket.stream().next_layer();
  // It keeps what it needs of the context.
  stream.use_tls(context);
  expect_name(stream.native_handle(), to.url.host);
  const auto greeted = socket.run(to.deadline, [&](auto end) {
    stream.async_handshake(asio::ssl::stream_base::client, {},
                           [end](const error_code& error, std::size_t) { end(error); });
  });
  if (!greeted) return tl::unexpected(greeted.error());
  if (!*greeted) return {};
  const auto verdict = SSL_get_verify_result(stream.native_handle());
  const auto why = verdict == X509_V_OK ? greeted->message()
                                        : std::string(X509_verify_cert_error_string(verdict));
  return tl::unexpected(unreachable(to.place.url, why, hint_for_certificate(verdict, to.place)));
}

Result<void> trust(asio::ssl::context& context, const WebPlace& place) {
  error_code error;
  context.set_verify_mode(asio::ssl::verify_peer);
  if (place.ca_file.empty()) {
    context.set_default_verify_paths(error);
  } else {
    // What OpenSSL says of a file that is not there is "system lib".
    constexpr std::size_t most_bytes = 1U << 20U;
    if (const auto text = read_file(place.ca_file, most_bytes); !text)
      return tl::unexpected(wrong(fmt::format("cannot read {}: {}", place.ca_file, text.error())));
    context.load_verify_file(place.ca_file, error);
  }
  if (!error) return {};
  return tl::unexpected(
      wrong(fmt::format("cannot use {} as certificate: {}",
                        place.ca_file.empty() ? "the system's" : place.ca_file, error.message())));
}

}  // namespace

Result<std::unique_ptr<client::LineChannel>> open_web_socket(const WebPlace& place,
                                                             tmcl::Duration at_most,
                                                             std::function<bool()> cancelled) {
  const auto url = parse_url(place.url);
  if (!url) return tl::unexpected(url.error());
  std::string token;
  if (!place.token_file.empty()) {
    auto read = token_in(place.token_file);
    if (!read) return tl::unexpected(std::move(read.error()));
    token = std::move(*read);
  }
  asio::ssl::context context(asio::ssl::context::tls_client);
  auto trusted = url->is_secure ? trust(context, place) : Result<void>{};
  if (!trusted) return tl::unexpected(std::move(trusted.error()));
  auto runner = std::make_unique<Runner>(std::move(cancelled));
  const Handshake to{place, *url, std::move(token), runner->now() + at_most};
  auto socket = std::make_unique<WebSocket>(place.url, std::move(runner));
  return connect(*socket, to)
      .and_then([&] { return secure(*socket, context, to); })
      .and_then([&] { return upgrade(*socket, to); })
      .map([&] { return std::unique_ptr<client::LineChannel>(std::move(socket)); });
}

}  // namespace tmclctl
