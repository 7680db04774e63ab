// A CAN interface of this computer, usually a virtual one, for hosts that speak SocketCAN.
#include <cerrno>
#include <exception>
#include <utility>

#include <boost/asio/posix/stream_descriptor.hpp>

#include "async/readiness.hpp"
#include "fronts/port.hpp"
#include "fronts/port_session.hpp"
#include "tmcl/can_socket.hpp"
#include "tmcl/timer.hpp"

namespace tmcld {
namespace {

using boost::system::error_code;
using Descriptor = boost::asio::posix::stream_descriptor;

/// While the interface is missing or down.
constexpr tmcl::Duration look_again = std::chrono::milliseconds(200);

/// Nothing tells when a host goes: its axes are given back when they stand and it is quiet.
class CanPort final : public Port, public std::enable_shared_from_this<CanPort> {
 public:
  CanPort(const PortConfig& config, const tmcl::CanName& name, std::shared_ptr<Gateway> gateway,
          CanSockets sockets)
      : config_(config),
        interface_(name.interface),
        sockets_(std::move(sockets)),
        gateway_(std::move(gateway)),
        socket_(gateway_->buses().front()->executor()),
        pause_(socket_.get_executor()) {}

  void start() override { look(); }
  void close() override {
    closed_ = true;
    if (session_) session_->close();
    pause_.cancel();
    error_code ignored;
    socket_.close(ignored);
  }

 private:
  /// Until it is closed.
  void look() {
    if (closed_) return;
    const bool is_open = socket_.is_open() && sockets_.is_on(socket_.native_handle(), interface_);
    if (!is_open && !open()) return look_later();
    wait_for_input(socket_, room_, [self = shared_from_this()](const error_code& error) {
      if (self->closed_) return;
      // While the interface is down every look gives an error.
      if (error || !self->take_frames()) return self->look_later();
      self->look();
    });
  }
  void look_later() {
    pause_.expires_after(look_again);
    pause_.async_wait([self = shared_from_this()](const error_code&) { self->look(); });
  }

  /// A socket stays with an interface that was deleted, and hears no other of its name.
  bool open() {
    error_code ignored;
    if (socket_.is_open()) socket_.close(ignored);
    auto opened = sockets_.open(interface_);
    if (!opened) {
      tell(LogLevel::warning, opened.error());
      return false;
    }
    socket_.assign(opened->release());
    tell(LogLevel::info, "bus " + config_.bus + " on " + interface_);
    return true;
  }

  /// A new one after one that has failed.
  std::shared_ptr<PortSession> session() {
    if (session_) return session_;
    session_ = std::make_shared<PortSession>(
        gateway_, config_, "port " + config_.name,
        [weak = weak_from_this()](const Told& told, CanForm form) {
          if (const auto self = weak.lock()) self->write(told, form);
        },
        [weak = weak_from_this()] {
          if (const auto self = weak.lock()) self->session_.reset();
        });
    session_->start();
    return session_;
  }

  bool take_frames() {
    auto got = tmcl::read_can(socket_.native_handle());
    for (; got.error == 0; got = tmcl::read_can(socket_.native_handle())) {
      const auto request = got.frame ? tmcl::decode_can_request(*got.frame) : std::nullopt;
      if (request) hear(*request, {got.frame->extended, got.frame->length});
    }
    return got.error == EAGAIN || got.error == EINTR;
  }

  void hear(const tmcl::Request& request, CanForm form) {
    try {
      session()->on_request(request, form);
    } catch (...) {
      if (is_stop(intent_of(request))) gateway_->stop_in_need();
      fail(std::current_exception());
    }
  }
  void fail(const std::exception_ptr& failure) {
    if (const auto session = std::exchange(session_, nullptr)) session->close();
    gateway_->log_failure("port " + config_.name + ", whose hosts were forgotten", failure);
  }

  /// A frame that does not fit into the interface's queue is lost.
  void write(const Told& told, CanForm form) {
    const auto& bus = session()->bus();
    const auto identifier = bus.is_can() ? bus.config().link_options.can_reply_id
                                         : std::uint32_t{tmcl::default_can_reply_id};
    if (socket_.is_open()) tmcl::write_can(socket_.native_handle(), to_can(told, identifier, form));
  }

  void tell(LogLevel level, const std::string& what) {
    if (what == std::exchange(told_, what)) return;
    gateway_->log(level, "port " + config_.name + ": " + what);
  }

  PortConfig config_;
  std::string interface_;
  CanSockets sockets_;
  std::shared_ptr<Gateway> gateway_;
  Descriptor socket_;
  WaitingRoom room_;
  tmcl::Timer pause_;
  std::shared_ptr<PortSession> session_;
  std::string told_;
  bool closed_ = false;
};

}  // namespace

tl::expected<std::shared_ptr<Port>, std::string> open_can_port(const PortConfig& config,
                                                               const tmcl::CanName& name,
                                                               std::shared_ptr<Gateway> gateway,
                                                               CanSockets sockets) {
  return std::make_shared<CanPort>(config, name, std::move(gateway), std::move(sockets));
}

}  // namespace tmcld
