// A CAN interface of this computer, usually a virtual one, for hosts that speak SocketCAN.
#include <cerrno>
#include <utility>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "fronts/port.hpp"
#include "fronts/port_session.hpp"
#include "tmcl/can_socket.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using Descriptor = boost::asio::posix::stream_descriptor;

/// While the interface is missing or down.
constexpr tmcl::Duration look_again = std::chrono::milliseconds(200);

/// Nothing tells when a host goes: its axes are given back when they stand and it is quiet.
class CanPort final : public Port, public std::enable_shared_from_this<CanPort> {
 public:
  CanPort(const PortConfig& config, const tmcl::CanName& name, std::shared_ptr<Gateway> gateway)
      : config_(config),
        interface_(name.interface),
        gateway_(std::move(gateway)),
        socket_(gateway_->buses().front()->executor()) {}

  void start() override { spawn(socket_.get_executor(), serve(shared_from_this())); }
  void close() override {
    closed_ = true;
    if (session_) session_->close();
    boost::system::error_code ignored;
    socket_.close(ignored);
  }

 private:
  static awaitable<void> serve(std::shared_ptr<CanPort> self) {
    while (!self->closed_) {
      if (!self->open()) {
        co_await rest(look_again);
        continue;
      }
      while (!self->closed_ && tmcl::is_on(self->socket_.native_handle(), self->interface_)) {
        boost::system::error_code error;
        co_await self->socket_.async_wait(Descriptor::wait_read,
                                          redirect_error(use_awaitable, error));
        // While the interface is down every look gives an error.
        if (self->closed_) break;
        if (error || !self->take_frames()) co_await rest(look_again);
      }
    }
  }

  /// A socket stays with an interface that was deleted, and hears no other of its name.
  bool open() {
    boost::system::error_code ignored;
    if (socket_.is_open()) socket_.close(ignored);
    auto opened = tmcl::open_can_socket(interface_);
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
      if (request) session()->on_request(*request, {got.frame->extended, got.frame->length});
    }
    return got.error == EAGAIN || got.error == EINTR;
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
  std::shared_ptr<Gateway> gateway_;
  Descriptor socket_;
  std::shared_ptr<PortSession> session_;
  std::string told_;
  bool closed_ = false;
};

}  // namespace

tl::expected<std::shared_ptr<Port>, std::string> open_can_port(const PortConfig& config,
                                                               const tmcl::CanName& name,
                                                               std::shared_ptr<Gateway> gateway) {
  return std::make_shared<CanPort>(config, name, std::move(gateway));
}

}  // namespace tmcld
