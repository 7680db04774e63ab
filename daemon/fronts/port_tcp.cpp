// Serial lines over TCP, as a serial device server offers them: the nine bytes, and nothing else.
#include <array>
#include <exception>
#include <set>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "fronts/descriptors.hpp"
#include "fronts/port.hpp"
#include "fronts/port_stream.hpp"

namespace tmcld {

namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;
using boost::system::error_code;

/// Further connections are closed at once.
constexpr std::size_t most_hosts = 8;

/// One connection.
class Host : public std::enable_shared_from_this<Host> {
 public:
  explicit Host(tcp::socket socket) : socket_(std::move(socket)) {
    error_code ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.set_option(boost::asio::socket_base::keep_alive(true), ignored);
    socket_.non_blocking(true, ignored);
  }

  /// Until it goes.
  static awaitable<void> serve(std::shared_ptr<Host> self, const PortConfig& config,
                               std::shared_ptr<Gateway> gateway) {
    const auto session = std::make_shared<PortSession>(
        gateway, config, "port " + config.name + " of " + self->peer(),
        [weak = self->weak_from_this()](const Told& told, CanForm) {
          if (const auto host = weak.lock()) host->write(to_serial(told));
        },
        [weak = self->weak_from_this()] {
          if (const auto host = weak.lock()) host->close();
        },
        self->peer());
    const auto stream = std::make_shared<PortStream>(
        session, self->socket_.get_executor(), [weak = self->weak_from_this()] {
          const auto host = weak.lock();
          return host && host->socket_.is_open() && has_input(host->socket_.native_handle());
        });
    std::exception_ptr failure;
    try {
      session->start();
      std::array<std::uint8_t, 1024> bytes{};
      while (true) {
        error_code error;
        const auto size = co_await self->socket_.async_read_some(
            boost::asio::buffer(bytes), redirect_error(use_awaitable, error));
        if (error) break;
        hear(*stream, std::span(bytes).first(size), *gateway);
      }
    } catch (...) {
      failure = std::current_exception();
    }
    stream->close();
    if (failure) std::rethrow_exception(failure);
  }

  void close() {
    error_code ignored;
    socket_.close(ignored);
  }

 private:
  static void hear(PortStream& stream, std::span<const std::uint8_t> bytes, Gateway& gateway) {
    try {
      stream.receive(bytes);
    } catch (...) {
      if (asks_for_stop(bytes)) gateway.stop_in_need();
      throw;
    }
  }
  std::string peer() const {
    error_code error;
    const auto end = socket_.remote_endpoint(error);
    return error ? "a host that has gone"
                 : end.address().to_string() + ":" + std::to_string(end.port());
  }
  void write(const tmcl::SerialBytes& bytes) {
    error_code error;
    const auto sent = socket_.write_some(boost::asio::buffer(bytes), error);
    // Half an answer would put the host out of step for good.
    if (error || sent != bytes.size()) close();
  }

  tcp::socket socket_;
};

class TcpPort final : public Port, public std::enable_shared_from_this<TcpPort> {
 public:
  TcpPort(const PortConfig& config, std::shared_ptr<Gateway> gateway, tcp::acceptor acceptor)
      : config_(config), gateway_(std::move(gateway)), acceptor_(std::move(acceptor)) {}

  void start() override { spawn(acceptor_.get_executor(), accept(shared_from_this())); }
  void close() override {
    error_code ignored;
    acceptor_.close(ignored);
    for (const auto& host : hosts_) host->close();
  }

 private:
  static awaitable<void> accept(std::shared_ptr<TcpPort> self) {
    while (self->acceptor_.is_open()) {
      error_code error;
      auto socket = co_await self->acceptor_.async_accept(redirect_error(use_awaitable, error));
      if (!self->acceptor_.is_open()) break;
      if (error) {
        co_await rest(pause_after_failure);
      } else if (self->hosts_.size() < most_hosts) {
        self->begin_to_serve(std::move(socket));
      } else {
        self->gateway_->log_often("port " + self->config_.name, LogLevel::warning,
                                  "port " + self->config_.name +
                                      ": a connection was closed, there are " +
                                      std::to_string(most_hosts) + " already");
      }
    }
  }
  void begin_to_serve(tcp::socket socket) {
    const auto self = shared_from_this();
    try {
      const auto host = std::make_shared<Host>(std::move(socket));
      spawn(acceptor_.get_executor(), serve(self, host), [self, host](const auto& failure) {
        host->close();
        self->hosts_.erase(host);
        self->tell(failure);
      });
    } catch (...) {
      tell(std::current_exception());
    }
  }
  void tell(const std::exception_ptr& failure) {
    gateway_->log_failure("a host at port " + config_.name + ", which was cut off", failure);
  }
  static awaitable<void> serve(std::shared_ptr<TcpPort> self, std::shared_ptr<Host> host) {
    self->hosts_.insert(host);
    auto serving = Host::serve(host, self->config_, self->gateway_);
    co_await std::move(serving);
    host->close();
    self->hosts_.erase(host);
  }

  PortConfig config_;
  std::shared_ptr<Gateway> gateway_;
  tcp::acceptor acceptor_;
  std::set<std::shared_ptr<Host>> hosts_;
};

}  // namespace

tl::expected<std::shared_ptr<Port>, std::string> open_tcp_port(const PortConfig& config,
                                                               const tmcl::TcpName& name,
                                                               std::shared_ptr<Gateway> gateway) {
  const auto executor = gateway->buses().front()->executor();
  const auto where = name.host + ":" + std::to_string(name.port);
  error_code error;
  const auto found = tcp::resolver(executor).resolve(name.host, std::to_string(name.port),
                                                     tcp::resolver::passive, error);
  if (error) return tl::unexpected("cannot find the host '" + name.host + "': " + error.message());
  const auto local = found.begin()->endpoint();
  tcp::acceptor acceptor(executor);
  acceptor.open(local.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(local, error);
  if (!error) acceptor.listen(boost::asio::socket_base::max_listen_connections, error);
  if (error) return tl::unexpected("cannot listen on " + where + ": " + error.message());
  gateway->log(LogLevel::info, "port " + config.name + ": bus " + config.bus + " on " + where);
  return std::make_shared<TcpPort>(config, std::move(gateway), std::move(acceptor));
}

}  // namespace tmcld
