#include "fronts/http_server.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <utility>

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/ip/network_v6.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "fronts/descriptors.hpp"
#include "fronts/http_connection.hpp"

namespace tmcld {
namespace {

namespace asio = boost::asio;
using asio::awaitable;
using asio::redirect_error;
using asio::use_awaitable;
using boost::system::error_code;
using Tcp = asio::ip::tcp;
using namespace std::chrono_literals;

constexpr int backlog = 128;
// Between looks for connections by which nothing is asked any more.
constexpr auto idle_look_interval = 5s;

std::string in_brackets(const HttpAddress& address) {
  return address.host.find(':') == std::string::npos ? address.host : "[" + address.host + "]";
}

std::string text_of(const Tcp::endpoint& endpoint) {
  const auto host = endpoint.address().to_string();
  const auto port = std::to_string(endpoint.port());
  return endpoint.address().is_v6() ? "[" + host + "]:" + port : host + ":" + port;
}

/// Of the addresses that one client can have at will.
std::string network_of(const asio::ip::address& address) {
  if (address.is_v4()) return address.to_string();
  const auto v6 = address.to_v6();
  if (v6.is_v4_mapped()) return asio::ip::make_address_v4(asio::ip::v4_mapped, v6).to_string();
  constexpr unsigned short bits_of_a_site = 64;
  return asio::ip::make_network_v6(v6, bits_of_a_site).canonical().to_string();
}

class Server final : public HttpServer, public std::enable_shared_from_this<Server> {
 public:
  Server(const asio::any_io_executor& executor, const HttpConfig& config,
         std::shared_ptr<Gateway> gateway, std::shared_ptr<FrontShare> share, std::size_t clients,
         Tls tls)
      : executor_(executor),
        connections_(std::make_shared<HttpConnections>(executor, std::move(gateway),
                                                       std::move(share), config, clients)),
        tls_(std::move(tls)) {}

  /// Empty, or why not.
  std::string listen(const HttpAddress& address) {
    error_code error;
    const Tcp::endpoint endpoint(asio::ip::make_address(address.host, error), address.port);
    auto& acceptor = acceptors_.emplace_back(executor_);
    if (!error) acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(Tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(backlog, error);
    if (!error) return {};
    return "cannot listen on " + in_brackets(address) + ":" + std::to_string(address.port) + ": " +
           error.message() + "; change 'listen' in [http], or end what has it";
  }

  /// Where a browser finds the page; it may be on another computer.
  void tell_page() {
    auto& told = connections_->share->page_addresses;
    for (const auto& acceptor : acceptors_) {
      error_code ignored;
      const auto endpoint = acceptor.local_endpoint(ignored);
      const auto port = ":" + std::to_string(endpoint.port());
      const auto& address = endpoint.address();
      const auto host = address.is_loopback()      ? "localhost" + port
                        : address.is_unspecified() ? asio::ip::host_name(ignored) + port
                                                   : text_of(endpoint);
      told.push_back((tls_.context ? "https://" : "http://") + host);
    }
  }

  void start() override {
    if (!tls_.age_problem.empty()) connections_->gateway->log(LogLevel::warning, tls_.age_problem);
    connections_->share->tokens->on_removed([weak = weak_from_this()](const std::string& token) {
      if (const auto self = weak.lock()) self->connections_->end_by_token(token);
    });
    for (auto& acceptor : acceptors_) spawn(executor_, accept(shared_from_this(), acceptor));
    spawn(executor_, end_idle_connections(shared_from_this()));
  }
  void stop_accepting() override {
    error_code ignored;
    for (auto& acceptor : acceptors_) acceptor.close(ignored);
  }
  void finish_sessions() override {
    for (const auto& connection : connections_->all()) connection->finish();
  }
  void close_sessions() override {
    for (const auto& connection : connections_->all()) connection->close();
  }
  void review_rights() override {
    for (const auto& connection : connections_->all()) connection->end_if_it_lost_rights();
  }
  void join() override { connections_->handshakes.join(); }
  std::size_t connections() const override { return connections_->size(); }
  std::vector<std::string> addresses() const override {
    std::vector<std::string> all;
    for (const auto& acceptor : acceptors_) {
      error_code ignored;
      all.push_back((tls_.context ? "https://" : "http://") +
                    text_of(acceptor.local_endpoint(ignored)));
    }
    return all;
  }

 private:
  static awaitable<void> accept(std::shared_ptr<Server> self, Tcp::acceptor& acceptor) {
    while (acceptor.is_open()) {
      error_code error;
      auto socket = co_await acceptor.async_accept(redirect_error(use_awaitable, error));
      if (!error) {
        self->take_in(std::move(socket));
        continue;
      }
      if (!acceptor.is_open()) break;
      co_await rest(pause_after_failure);
    }
  }

  static awaitable<void> end_idle_connections(std::shared_ptr<Server> self) {
    const auto& clock = self->connections_->gateway->clock();
    while (std::ranges::any_of(self->acceptors_, &Tcp::acceptor::is_open)) {
      co_await rest(idle_look_interval);
      self->connections_->end_what_has_expired();
      for (const auto& connection : self->connections_->all()) connection->end_if_idle(clock.now());
    }
  }

  void take_in(Tcp::socket socket) {
    error_code error;
    const auto peer = socket.remote_endpoint(error);
    const auto own = socket.local_endpoint(error);
    if (error) return;  // it has gone already
    socket.set_option(Tcp::no_delay(true), error);
    keep_alive(socket);
    HttpConnectionInfo info;
    info.peer = text_of(peer);
    info.network = network_of(peer.address());
    info.is_loopback = peer.address().is_loopback() && own.address().is_loopback();
    info.has_tls = tls_.context != nullptr;
    info.port = own.port();
    begin_http_connection(std::move(socket), tls_.context, std::move(info), connections_);
  }

  /// A client that waits for a long answer is silent: the system finds out if it is gone.
  static void keep_alive(Tcp::socket& socket) {
    error_code ignored;
    socket.set_option(asio::socket_base::keep_alive(true), ignored);
    using Seconds = std::array<std::pair<int, int>, 3>;
    for (const auto& [option, value] :
         Seconds{{{TCP_KEEPIDLE, 15}, {TCP_KEEPINTVL, 5}, {TCP_KEEPCNT, 3}}})
      ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &value, sizeof value);
  }

  asio::any_io_executor executor_;
  std::shared_ptr<HttpConnections> connections_;
  Tls tls_;
  std::deque<Tcp::acceptor> acceptors_;
};

}  // namespace

std::vector<std::string> problems_of_files(const HttpConfig& config) {
  const auto tls = tls_of(config);
  if (!tls) return {tls.error()};
  if (!tls->age_problem.empty()) return {tls->age_problem};
  return {};
}

std::vector<std::string> advice_on_files(const HttpConfig& config) {
  const auto tls = tls_of(config);
  if (!tls || tls->advice.empty()) return {};
  return {tls->advice};
}

tl::expected<std::shared_ptr<HttpServer>, std::string> HttpServer::create(
    const asio::any_io_executor& executor, const HttpConfig& config,
    std::shared_ptr<Gateway> gateway, std::shared_ptr<FrontShare> share, std::size_t clients) {
  auto tls = tls_of(config);
  if (!tls) return tl::unexpected(std::move(tls.error()));
  const auto server = std::make_shared<Server>(executor, config, std::move(gateway),
                                               std::move(share), clients, std::move(*tls));
  for (const auto& address : config.listen) {
    auto problem = server->listen(address);
    if (!problem.empty()) return tl::unexpected(std::move(problem));
  }
  server->tell_page();
  return server;
}

}  // namespace tmcld
