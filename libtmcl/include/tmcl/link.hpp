/// A way out to modules: an open descriptor and the form in which datagrams travel on it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/error.hpp"
#include "tmcl/link_name.hpp"

namespace tmcl {

class UsbPort;

enum class Framing : std::uint8_t {
  serial,  ///< A stream of bytes with nine of them to a datagram; one request at a time.
  can,     ///< Frames; one request at a time for each module.
};

struct LinkOptions {
  /// CAN: which identifier replies come with (global parameter 70). The kernel drops everything
  /// else.
  std::uint32_t can_reply_id = default_can_reply_id;
  /// CAN: use 29-bit identifiers.
  bool can_extended = false;
  /// TCP: how long connecting may take, to all addresses of the host together.
  Duration connect_timeout = std::chrono::seconds(3);
};

/// What came in on CAN that is no datagram.
struct CanCondition {
  std::string text;     ///< "bus-off", "error-passive", ...
  bool severe = false;  ///< Nothing can be sent until the controller recovers.
};

using CanInput = std::variant<CanFrame, CanCondition>;

/// Move-only; closes its descriptor. Never blocks: a call that would have to wait says so.
class Link {
 public:
  /// Opens what the name says. May block (name resolution, connecting), so a program with a reactor
  /// calls it on another thread. A serial port is for one program of this computer at a time, a CAN
  /// interface for one with each reply identifier. A USB device whose terminal a program has open
  /// is left to it. A program that itself looks for devices by libusb up to 1.0.26 begins with that
  /// before it opens one here. Errors: Errc::bad_argument for a bad name;
  /// Errc::link_busy, naming the program that holds the port where it can be found;
  /// Errc::link_open_failed with what the system said and what to try.
  static Result<Link> open(std::string_view name, const LinkOptions& options = {});
  static Result<Link> open(const LinkName& name, const LinkOptions& options = {});
  /// Takes over a descriptor: a stream of bytes, or datagrams that each carry one struct can_frame.
  static Link adopt(int descriptor, Framing framing, std::string name);
  /// Two ends in memory, joined: what one writes the other reads.
  static Result<std::pair<Link, Link>> memory_pair(Framing framing);

  Link(Link&& other) noexcept;
  Link& operator=(Link&& other) noexcept;
  ~Link();

  int descriptor() const { return descriptor_; }
  Framing framing() const { return framing_; }
  const std::string& name() const { return name_; }
  /// How long a request and its reply are on the wire; zero where that cannot be known.
  Duration wire_time() const { return wire_time_; }
  bool can_extended() const { return can_extended_; }

  /// Reads what is there; 0 if there is nothing now. Only for Framing::serial.
  Result<std::size_t> read(std::span<std::uint8_t> into);
  /// Writes as much as goes now; 0 if nothing goes. Only for Framing::serial.
  Result<std::size_t> write(std::span<const std::uint8_t> bytes);
  /// Nothing if there is no frame now. Only for Framing::can.
  Result<std::optional<CanInput>> read_frame();
  /// False if the transmit queue is full. Only for Framing::can.
  Result<bool> write_frame(const CanFrame& frame);

 private:
  Link(int descriptor, Framing framing, std::string name);
  friend Result<Link> open_serial(const SerialName&, const std::string&);
  friend Result<Link> open_can(const CanName&, const std::string&, const LinkOptions&);
  friend Result<Link> open_tcp(const TcpName&, const std::string&, const LinkOptions&);
  friend Result<Link> open_usb(const UsbName&, const std::string&);

  int descriptor_ = -1;
  /// What keeps other programs off the port; undone before the descriptor is closed.
  std::shared_ptr<void> lock_;
  Framing framing_ = Framing::serial;
  std::string name_;
  Duration wire_time_{};
  bool can_extended_ = false;
  bool is_socket_ = false;
  std::shared_ptr<UsbPort> usb_;  ///< Null for what is read from the descriptor.
};

}  // namespace tmcl
