#include "sim/ports/pty_stream.hpp"

#include <utility>

#include <boost/asio/buffer.hpp>

namespace tmcl::sim {

namespace asio = boost::asio;

PtyStream::PtyStream(asio::io_context& io, Pty pty, LinkFile link)
    : master_(io, pty.master.release()),
      slave_(std::move(pty.slave)),
      slave_name_(std::move(pty.slave_name)),
      link_(std::move(link)) {
  master_.non_blocking(true);
}

void PtyStream::read(std::function<void(std::span<const std::uint8_t>)> receive) {
  receive_ = std::move(receive);
  read_on();
}

void PtyStream::read_on() {
  master_.async_read_some(asio::buffer(input_), [this](const auto& error, std::size_t size) {
    if (error) return;
    receive_(std::span(input_).first(size));
    read_on();
  });
}

void PtyStream::write(std::span<const std::uint8_t> bytes) {
  boost::system::error_code full;
  master_.write_some(asio::buffer(bytes.data(), bytes.size()), full);
}

tl::expected<LinkedPty, std::string> open_linked_pty(const std::filesystem::path& path) {
  auto pty = open_pty();
  if (!pty) return tl::unexpected(pty.error());
  auto link = LinkFile::create(path, pty->slave_name);
  if (!link) return tl::unexpected(link.error());
  return LinkedPty{std::move(*pty), std::move(*link)};
}

}  // namespace tmcl::sim
