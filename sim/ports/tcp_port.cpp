#include "sim/ports/tcp_port.hpp"

#include <array>
#include <chrono>
#include <list>
#include <memory>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "sim/ports/silence.hpp"
#include "sim/wire/serial_line.hpp"

namespace tmcl::sim {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

// With no descriptors left, accepting fails at once and for ever: not so often, then.
constexpr auto pause_after_failure = std::chrono::milliseconds(100);

class Client {
 public:
  Client(asio::io_context& io, tcp::socket socket, Scheduler& scheduler, const SerialWire& wire)
      : socket_(std::move(socket)),
        silence_(io, socket_.native_handle()),
        scheduler_(&scheduler),
        line_(
            scheduler.bench(), [this](auto bytes) { write(bytes); }, wire) {
    error_code ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.non_blocking(true, ignored);
  }

  /// `gone` is called once, when the connection has ended; it may destroy the client.
  template <typename Gone>
  void serve(Gone gone) {
    socket_.async_read_some(asio::buffer(input_),
                            [this, gone](const error_code& error, std::size_t size) {
                              if (error == asio::error::operation_aborted && !closed_by_us_) return;
                              if (error) return gone();
                              line_.receive(std::span(input_).first(size), silence_.seen_at());
                              scheduler_->touch();
                              if (line_.is_unfinished()) silence_.look_later();
                              serve(gone);
                            });
  }

 private:
  void write(std::span<const std::uint8_t> bytes) {
    error_code error;
    const auto sent = socket_.write_some(asio::buffer(bytes.data(), bytes.size()), error);
    if (!error && sent == bytes.size()) return;
    // Half a reply would put the client out of step for good; the read ends with it.
    closed_by_us_ = true;
    socket_.close(error);
  }

  tcp::socket socket_;
  Silence silence_;
  Scheduler* scheduler_;
  bool closed_by_us_ = false;
  SerialLine line_;
  std::array<std::uint8_t, 1024> input_{};
};

class TcpPort final : public Port {
 public:
  TcpPort(asio::io_context& io, Scheduler& scheduler, tcp::acceptor acceptor,
          const SerialWire& wire)
      : io_(&io),
        wire_(wire),
        scheduler_(&scheduler),
        acceptor_(std::move(acceptor)),
        pause_(io.get_executor()) {
    accept();
  }

  std::string description() const override {
    const auto local = acceptor_.local_endpoint();
    const auto host = local.address().to_string();
    const auto shown = local.address().is_v6() ? "[" + host + "]" : host;
    return "tcp " + shown + ":" + std::to_string(local.port());
  }

 private:
  void accept() {
    acceptor_.async_accept([this](const error_code& error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) return accept_later();
      if (clients_.size() < most_tcp_clients) admit(std::move(socket));
      accept();
    });
  }

  void accept_later() {
    pause_.expires_after(pause_after_failure);
    pause_.async_wait([this](const error_code& error) {
      if (!error) accept();
    });
  }

  void admit(tcp::socket socket) {
    const auto client = clients_.insert(
        clients_.end(), std::make_unique<Client>(*io_, std::move(socket), *scheduler_, wire_));
    (*client)->serve([this, client] { clients_.erase(client); });
  }

  asio::io_context* io_;
  SerialWire wire_;
  Scheduler* scheduler_;
  tcp::acceptor acceptor_;
  Timer pause_;
  std::list<std::unique_ptr<Client>> clients_;
};

}  // namespace

OpenedPort open_tcp_port(asio::io_context& io, Scheduler& scheduler, const Endpoint& endpoint,
                         const SerialWire& wire) {
  error_code error;
  const auto found =
      tcp::resolver(io).resolve(endpoint.host, endpoint.port, tcp::resolver::passive, error);
  if (error) {
    return tl::unexpected("cannot find the host '" + endpoint.host + "': " + error.message());
  }
  const auto local = found.begin()->endpoint();
  tcp::acceptor acceptor(io);
  acceptor.open(local.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(local, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    return tl::unexpected("cannot listen on " + endpoint.host + ":" + endpoint.port + ": " +
                          error.message());
  return std::make_unique<TcpPort>(io, scheduler, std::move(acceptor), wire);
}

}  // namespace tmcl::sim
