#include "tmcl/link.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include "link/can_condition.hpp"
#include "link/opening.hpp"
#include "link/usb_port.hpp"

namespace tmcl {
namespace {

bool would_block(int error) { return error == EAGAIN || error == EINTR; }

bool is_socket(int descriptor) {
  int type = 0;
  socklen_t size = sizeof type;
  return getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) == 0;
}

}  // namespace

tl::unexpected<Error> because(Errc code, std::string why) {
  return tl::unexpected(not_sent(code, std::move(why)));
}

std::string system_text(int error) { return std::generic_category().message(error); }

tl::unexpected<Error> cannot_open(const std::string& link, const std::string& why,
                                  const std::string& hint) {
  Error error{Errc::link_open_failed,
              Outcome::not_sent,
              "cannot open " + link + ": " + why,
              hint,
              link,
              {},
              {}};
  return tl::unexpected(std::move(error));
}

tl::unexpected<Error> busy(const std::string& link, const std::string& holder) {
  return tl::unexpected(
      Error{Errc::link_busy,
            Outcome::not_sent,
            link + " is in use by " + (holder.empty() ? "another program" : holder),
            "end that program, or let tmcld own the port and share it",
            link,
            {},
            {}});
}

Result<Link> Link::open(std::string_view name, const LinkOptions& options) {
  return parse_link_name(name).and_then(
      [&](const LinkName& parsed) { return open(parsed, options); });
}

Result<Link> Link::open(const LinkName& name, const LinkOptions& options) {
  const auto text = to_string(name);
  if (const auto* serial = std::get_if<SerialName>(&name)) return open_serial(*serial, text);
  if (const auto* can = std::get_if<CanName>(&name)) return open_can(*can, text, options);
  if (const auto* usb = std::get_if<UsbName>(&name)) return open_usb(*usb, text);
  return open_tcp(std::get<TcpName>(name), text, options);
}

Link Link::adopt(int descriptor, Framing framing, std::string name) {
  const int flags = fcntl(descriptor, F_GETFL);
  if (flags >= 0) fcntl(descriptor, F_SETFL, flags | O_NONBLOCK);
  return {descriptor, framing, std::move(name)};
}

Link::Link(int descriptor, Framing framing, std::string name)
    : descriptor_(descriptor),
      framing_(framing),
      name_(std::move(name)),
      is_socket_(is_socket(descriptor)) {}

Link::Link(Link&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      lock_(std::move(other.lock_)),
      framing_(other.framing_),
      name_(std::move(other.name_)),
      wire_time_(other.wire_time_),
      can_extended_(other.can_extended_),
      is_socket_(other.is_socket_),
      usb_(std::move(other.usb_)) {}

Link& Link::operator=(Link&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(lock_, other.lock_);
  framing_ = other.framing_;
  std::swap(name_, other.name_);
  wire_time_ = other.wire_time_;
  can_extended_ = other.can_extended_;
  is_socket_ = other.is_socket_;
  std::swap(usb_, other.usb_);
  return *this;
}

Link::~Link() {
  usb_.reset();
  lock_.reset();
  if (descriptor_ >= 0) ::close(descriptor_);
}

namespace {

tl::unexpected<Error> lost(const std::string& link, const std::string& why) {
  return tl::unexpected(Error{Errc::link_lost,
                              Outcome::unknown,
                              why,
                              "check the cable and the module's power",
                              link,
                              {},
                              {}});
}

Result<std::size_t> told(const std::string& link, tl::expected<std::size_t, std::string> count) {
  if (!count) return lost(link, count.error());
  return *count;
}

}  // namespace

Result<std::size_t> Link::read(std::span<std::uint8_t> into) {
  if (usb_) return told(name_, usb_->read(into));
  const auto count = ::read(descriptor_, into.data(), into.size());
  if (count > 0) return static_cast<std::size_t>(count);
  if (count == 0) return lost(name_, "the other end has closed the link");
  if (would_block(errno)) return std::size_t{0};
  return lost(name_, system_text(errno));
}

Result<std::size_t> Link::write(std::span<const std::uint8_t> bytes) {
  if (usb_) return told(name_, usb_->write(bytes));
  // A closed socket is an error like any other, not a signal that ends the program.
  const auto count = is_socket_ ? ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                : ::write(descriptor_, bytes.data(), bytes.size());
  if (count >= 0) return static_cast<std::size_t>(count);
  if (would_block(errno)) return std::size_t{0};
  return lost(name_, system_text(errno));
}

Result<std::optional<CanInput>> Link::read_frame() {
  can_frame raw{};
  const auto count = ::read(descriptor_, &raw, sizeof raw);
  if (count < 0 && would_block(errno)) return std::nullopt;
  if (count < 0) return lost(name_, system_text(errno));
  if (count != sizeof raw) return lost(name_, "the other end has closed the link");
  if ((raw.can_id & CAN_ERR_FLAG) != 0) return describe_error_frame(raw);
  // No module answers with a remote frame; it carries no data to look at.
  if ((raw.can_id & CAN_RTR_FLAG) != 0) return std::nullopt;
  CanFrame frame;
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(raw.can_dlc, 8);
  std::memcpy(frame.data.data(), raw.data, frame.data.size());
  return frame;
}

Result<bool> Link::write_frame(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
  raw.can_dlc = frame.length;
  std::memcpy(raw.data, frame.data.data(), frame.data.size());
  if (::write(descriptor_, &raw, sizeof raw) == sizeof raw) return true;
  if (would_block(errno) || errno == ENOBUFS) return false;
  return lost(name_, system_text(errno));
}

}  // namespace tmcl
