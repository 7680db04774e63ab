/// A gateway in virtual time with two axes of one module, whose answers may go wrong, and clients
/// at the other ends of its sessions.
#pragma once

#include <csignal>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "config/load.hpp"
#include "fronts/unix_session.hpp"
#include "gateway/gateway.hpp"
#include "log/log.hpp"
#include "require.hpp"
#include "sim/bench.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/cable_config.hpp"

namespace tmcld::fuzz {

using tmcl::fuzz::require;

/// What becomes of answers on their way.
enum class Fate : std::uint8_t { delivered, lost, late, doubled, damaged };

/// The module, and the line that it is on.
class SessionWire {
 public:
  explicit SessionWire(boost::asio::io_context& context)
      : context_(&context),
        clock_(context),
        bench_(clock_),
        scheduler_(context, bench_),
        line_(bench_, [this](std::span<const std::uint8_t> bytes) { answer(bytes); }),
        readiness_(context) {
    bench_.add(*tmcl::find_model("TMCM-3110"), tmcl::ModuleAddress{1});
  }

  std::function<void(const tmcl::Request&)> on_request;
  /// Of so many answers.
  void spoil(Fate fate, unsigned answers) {
    fate_ = fate;
    spoilt_ = answers;
  }
  tmcl::Result<tmcl::Link> open() {
    auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
    if (!ends) return tl::unexpected(ends.error());
    far_ = std::make_unique<tmcl::Link>(std::move(ends->second));
    boost::system::error_code ignored;
    readiness_.close(ignored);
    readiness_.assign(::dup(far_->descriptor()));
    wait();
    return std::move(ends->first);
  }
  /// It can be opened again at once.
  void unplug() {
    boost::system::error_code ignored;
    readiness_.close(ignored);
    far_.reset();
  }

 private:
  static constexpr auto to_answer = std::chrono::milliseconds(1);
  static constexpr auto too_late = std::chrono::milliseconds(150);

  void wait() {
    readiness_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                          [this](const auto& error) {
                            if (!error && read()) wait();
                          });
  }
  /// False when the gateway has closed its end.
  bool read() {
    tmcl::SerialBytes bytes{};
    const auto count = far_->read(bytes);
    if (!count || *count == 0) return false;
    const auto sent = std::span(bytes).first(*count);
    const auto request = tmcl::decode_serial_request(bytes);
    const bool is_request = sent.size() == bytes.size() && request;
    require(is_request || ends_ascii_mode(sent), "whole requests come from the gateway");
    if (is_request) on_request(*request);
    line_.receive(sent);
    scheduler_.touch();
    return true;
  }
  /// Sent before a stop that was not answered is sent again.
  static bool ends_ascii_mode(std::span<const std::uint8_t> sent) {
    return std::string(sent.begin(), sent.end()) == "\rABIN\r";
  }
  void answer(std::span<const std::uint8_t> reply) {
    const auto fate = spoilt_ > 0 ? fate_ : Fate::delivered;
    spoilt_ -= spoilt_ > 0 ? 1 : 0;
    if (fate == Fate::lost) return;
    std::vector<std::uint8_t> bytes(reply.begin(), reply.end());
    if (fate == Fate::damaged) bytes.back() ^= 1U;
    const auto timer = std::make_shared<tmcl::Timer>(context_->get_executor());
    timer->expires_after(fate == Fate::late ? too_late : to_answer);
    timer->async_wait([this, timer, bytes, fate](const auto& error) {
      if (error || !far_) return;
      (void)far_->write(bytes);
      if (fate == Fate::doubled) (void)far_->write(bytes);
    });
  }

  boost::asio::io_context* context_;
  tmcl::ContextClock clock_;
  tmcl::sim::Bench bench_;
  tmcl::sim::Scheduler scheduler_;
  tmcl::sim::SerialLine line_;
  std::unique_ptr<tmcl::Link> far_;
  boost::asio::posix::stream_descriptor readiness_;
  Fate fate_ = Fate::delivered;
  unsigned spoilt_ = 0;
};

/// The client's end of a connection.
class SessionClient {
 public:
  SessionClient(boost::asio::io_context& context, const std::shared_ptr<Gateway>& gateway,
                Session::Serves serves) {
    int ends[2] = {};
    require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0, "sockets");
    descriptor_ = ends[0];
    UnixSession::Socket socket(context, boost::asio::local::stream_protocol(), ends[1]);
    const auto session = std::make_shared<UnixSession>(std::move(socket), gateway, serves, [] {});
    session_ = session;
    session->start();
  }
  SessionClient(const SessionClient&) = delete;
  SessionClient& operator=(const SessionClient&) = delete;
  ~SessionClient() { close(); }

  void send(std::string_view bytes) const {
    if (descriptor_ >= 0) (void)::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void end_input() const { ::shutdown(descriptor_, SHUT_WR); }
  void close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }
  /// What has come since the last time. False at the end of the connection.
  bool read(std::string& into) const {
    char bytes[4096];
    while (true) {
      const auto count = ::recv(descriptor_, bytes, sizeof bytes, 0);
      if (count <= 0) return count < 0 && errno == EAGAIN;
      into.append(bytes, static_cast<std::size_t>(count));
    }
  }
  /// The gateway has forgotten it.
  bool is_forgotten() const { return session_.expired(); }

 private:
  int descriptor_ = -1;
  std::weak_ptr<Session> session_;
};

class SessionWorld {
 public:
  SessionWorld() {
    std::signal(SIGPIPE, SIG_IGN);
    silence_log();
    GatewayOptions options;
    options.open_link = [this](const BusConfig&) { return wire.open(); };
    options.new_epoch = [last = std::int64_t{0}]() mutable { return ++last; };
    wire.on_request = [](const tmcl::Request&) {};
    gateway_ = Gateway::create(context_.get_executor(), configuration(), std::move(options));
    gateway_->start();
    time.run_for(std::chrono::milliseconds(100));
  }
  ~SessionWorld() {
    gateway_->close();
    wire.unplug();
    time.run_for(std::chrono::seconds(1));
  }
  SessionWorld(const SessionWorld&) = delete;
  SessionWorld& operator=(const SessionWorld&) = delete;

  std::unique_ptr<SessionClient> connect(Session::Serves serves) {
    return std::make_unique<SessionClient>(context_, gateway_, serves);
  }

 private:
  static const Config& configuration() {
    static const Config config = parse_config(test::cable_config).value();
    return config;
  }

  boost::asio::io_context context_{1};

 public:
  tmcl::VirtualTime time{context_};
  SessionWire wire{context_};

 private:
  std::shared_ptr<Gateway> gateway_;
};

}  // namespace tmcld::fuzz
