#include "sim/ports/pty_port.hpp"

#include <array>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "sim/ports/link_file.hpp"
#include "sim/ports/pty.hpp"
#include "sim/ports/silence.hpp"
#include "sim/wire/serial_line.hpp"

namespace tmcl::sim {
namespace {

namespace asio = boost::asio;

class PtyPort final : public Port {
 public:
  PtyPort(asio::io_context& io, Scheduler& scheduler, Pty pty, LinkFile link)
      : scheduler_(&scheduler),
        master_(io, pty.master.release()),
        silence_(io, master_.native_handle()),
        slave_(std::move(pty.slave)),
        slave_name_(std::move(pty.slave_name)),
        link_(std::move(link)),
        line_(scheduler.bench(), [this](auto bytes) { write(bytes); }) {
    master_.non_blocking(true);
    read();
  }

  std::string description() const override {
    return "pty " + link_.path().string() + " -> " + slave_name_;
  }

 private:
  void read() {
    master_.async_read_some(asio::buffer(input_), [this](const auto& error, std::size_t size) {
      if (error) return;
      line_.receive(std::span(input_).first(size), silence_.seen_at());
      scheduler_->touch();
      if (line_.is_unfinished()) silence_.look_later();
      read();
    });
  }

  void write(std::span<const std::uint8_t> bytes) {
    boost::system::error_code full;
    master_.write_some(asio::buffer(bytes.data(), bytes.size()), full);
  }

  Scheduler* scheduler_;
  asio::posix::stream_descriptor master_;
  Silence silence_;
  FileDescriptor slave_;
  std::string slave_name_;
  LinkFile link_;
  SerialLine line_;
  std::array<std::uint8_t, 1024> input_{};
};

}  // namespace

OpenedPort open_pty_port(asio::io_context& io, Scheduler& scheduler,
                         const std::filesystem::path& path) {
  auto pty = open_pty();
  if (!pty) return tl::unexpected(pty.error());
  auto link = LinkFile::create(path, pty->slave_name);
  if (!link) return tl::unexpected(link.error());
  return std::make_unique<PtyPort>(io, scheduler, std::move(*pty), std::move(*link));
}

}  // namespace tmcl::sim
