#include "serial_port.hpp"

#include <poll.h>

namespace tmclctl {

Result<void> SerialPort::open(std::uint32_t baud) {
  // Closed first: a port is for one opener at a time.
  link_.reset();
  auto link = attempt(tmcl::Link::open(tmcl::SerialName{device_, baud}));
  if (!link) return tl::unexpected(link.error());
  link_.emplace(std::move(*link));
  return {};
}

Result<void> SerialPort::send(std::span<const std::uint8_t> bytes) {
  // A question is shorter than what any port holds; of one that takes nothing nothing comes.
  return attempt(link_->write(bytes)).map([](std::size_t) {});
}

Result<std::size_t> SerialPort::receive(std::span<std::uint8_t> into, tmcl::Duration at_most) {
  pollfd entry{link_->descriptor(), POLLIN, 0};
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(at_most);
  ::poll(&entry, 1, static_cast<int>(wait.count()));
  return attempt(link_->read(into));
}

}  // namespace tmclctl
