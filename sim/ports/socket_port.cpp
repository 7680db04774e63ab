#include "sim/ports/socket_port.hpp"

#include <array>
#include <span>
#include <string>

#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "sim/wire/can_line.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/can_socket.hpp"

namespace tmcl::sim {
namespace {

namespace asio = boost::asio;

class SerialSocketPort final : public Port {
 public:
  SerialSocketPort(asio::io_context& io, Scheduler& scheduler, FileDescriptor socket,
                   const SerialWire& wire)
      : scheduler_(&scheduler),
        socket_(io, socket.release()),
        line_(
            scheduler.bench(), [this](auto bytes) { write(bytes); }, wire) {
    socket_.non_blocking(true);
    read_on();
  }

  std::string description() const override { return "serial line in this process"; }

 private:
  void read_on() {
    socket_.async_read_some(asio::buffer(input_), [this](const auto& error, std::size_t size) {
      if (error) return;  // the host has closed its end
      line_.receive(std::span(input_).first(size));
      scheduler_->touch();
      read_on();
    });
  }

  void write(std::span<const std::uint8_t> bytes) {
    boost::system::error_code full;
    socket_.write_some(asio::buffer(bytes.data(), bytes.size()), full);
  }

  Scheduler* scheduler_;
  asio::posix::stream_descriptor socket_;
  SerialLine line_;
  std::array<std::uint8_t, 1024> input_{};
};

class CanSocketPort final : public Port {
 public:
  CanSocketPort(asio::io_context& io, Scheduler& scheduler, FileDescriptor socket, Pace pace)
      : scheduler_(&scheduler),
        socket_(io, socket.release()),
        line_(
            scheduler.bench(),
            [this](const CanFrame& frame) { (void)write_can(socket_.native_handle(), frame); },
            pace) {
    wait();
  }

  std::string description() const override { return "CAN bus in this process"; }

 private:
  void wait() {
    socket_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const auto& error) {
      if (!error && drain()) wait();
    });
  }

  /// False when the host has closed its end: there is something to read, and it is no frame.
  bool drain() {
    auto got = read_can(socket_.native_handle());
    const bool is_closed = got.error == 0 && !got.frame;
    for (; got.frame; got = read_can(socket_.native_handle())) line_.receive(*got.frame);
    scheduler_->touch();
    return !is_closed;
  }

  Scheduler* scheduler_;
  asio::posix::stream_descriptor socket_;
  CanLine line_;
};

}  // namespace

std::unique_ptr<Port> serve_serial_socket(asio::io_context& io, Scheduler& scheduler,
                                          FileDescriptor socket, const SerialWire& wire) {
  return std::make_unique<SerialSocketPort>(io, scheduler, std::move(socket), wire);
}

std::unique_ptr<Port> serve_can_socket(asio::io_context& io, Scheduler& scheduler,
                                       FileDescriptor socket, Pace pace) {
  return std::make_unique<CanSocketPort>(io, scheduler, std::move(socket), pace);
}

}  // namespace tmcl::sim
