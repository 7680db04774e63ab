#include "sim/ports/can_port.hpp"

#include <cerrno>
#include <chrono>
#include <iostream>
#include <utility>

#include <boost/asio/posix/stream_descriptor.hpp>

#include "sim/wire/can_line.hpp"
#include "tmcl/can_socket.hpp"

namespace tmcl::sim {
namespace {

namespace asio = boost::asio;

// While the interface is down the socket reports an error at every look.
constexpr auto look_again = std::chrono::milliseconds(200);

class CanPort final : public Port {
 public:
  CanPort(asio::io_context& io, Scheduler& scheduler, FileDescriptor socket, std::string interface,
          Pace pace)
      : scheduler_(&scheduler),
        socket_(io, socket.release()),
        pause_(io.get_executor()),
        interface_(std::move(interface)),
        line_(
            scheduler.bench(), [this](const CanFrame& frame) { write(frame); }, pace) {
    wait();
  }

  std::string description() const override { return "can " + interface_; }

 private:
  void wait() {
    socket_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const auto& error) {
      if (error) return;
      drain();
    });
  }

  void drain() {
    auto got = read_can(socket_.native_handle());
    for (; got.error == 0; got = read_can(socket_.native_handle())) {
      if (got.frame) line_.receive(*got.frame);
      scheduler_->touch();
    }
    if (got.error == EAGAIN || got.error == EINTR) return wait();
    look_later();
  }

  void look_later() {
    pause_.expires_after(look_again);
    pause_.async_wait([this](const auto& error) {
      if (error) return;
      if (is_on(socket_.native_handle(), interface_)) return wait();
      open_again();
    });
  }

  // A socket stays with an interface that was deleted, and hears no other of its name.
  void open_again() {
    auto socket = open_can_socket(interface_);
    if (!socket) {
      if (!std::exchange(gone_, true)) tell(socket.error());
      return look_later();
    }
    socket_.close();
    socket_.assign(socket->release());
    gone_ = false;
    tell("the CAN interface '" + interface_ + "' is there again");
    wait();
  }

  static void tell(const std::string& what) { std::cerr << "tmclsim: " << what << '\n'; }

  // A frame that does not fit into the interface's queue is lost, as with a controller off the bus.
  void write(const CanFrame& frame) { (void)write_can(socket_.native_handle(), frame); }

  Scheduler* scheduler_;
  asio::posix::stream_descriptor socket_;
  Timer pause_;
  std::string interface_;
  bool gone_ = false;
  CanLine line_;
};

}  // namespace

OpenedPort open_can_port(asio::io_context& io, Scheduler& scheduler, const std::string& interface,
                         Pace pace) {
  auto socket = open_can_socket(interface);
  if (!socket) return tl::unexpected(socket.error());
  return std::make_unique<CanPort>(io, scheduler, std::move(*socket), interface, pace);
}

}  // namespace tmcl::sim
