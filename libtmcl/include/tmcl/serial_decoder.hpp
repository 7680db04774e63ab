/// The host's ear on a serial line: finds replies in a stream of bytes, whatever lies between them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include "tmcl/datagram.hpp"
#include "tmcl/version.hpp"

namespace tmcl {

/// The firmware version as text: nine bytes without address, status or checksum.
struct VersionText {
  std::uint8_t host = default_host_address;
  FirmwareVersion version;
  auto operator<=>(const VersionText&) const = default;
};

using SerialItem = std::variant<Reply, VersionText>;

/// Looks at the last nine bytes after each one that comes in. When they are a reply (or, if asked
/// for, a version text) it hands that out and starts afresh; otherwise the oldest byte is dropped
/// and the search goes on. So garbage costs no more than itself, and how the bytes were cut into
/// reads makes no difference.
///
/// Nine bytes pass for a reply if they begin with the host's address, carry a status that TMCL
/// defines and end with the right checksum.
class SerialDecoder {
 public:
  explicit SerialDecoder(std::uint8_t host_address = default_host_address) : host_(host_address) {}

  std::optional<SerialItem> push(std::uint8_t byte);

  /// While true, a version text is recognised too, and wins over a reply that the same bytes could
  /// be.
  void expect_version_text(bool expected) { version_text_expected_ = expected; }
  /// While true, a reply may carry any status: it is a line of a program.
  void expect_program_line(bool expected) { program_line_expected_ = expected; }
  /// A request goes out now: what has begun to come in before is no answer to it.
  void begin_exchange() { bytes_before_ = size_; }
  /// Of the item that push() gave last.
  bool began_before_exchange() const { return began_before_; }
  /// Forgets an unfinished datagram; its bytes count as dropped.
  void reset();

  /// Bytes that belonged to no datagram, since construction.
  std::uint64_t dropped_bytes() const { return dropped_; }

 private:
  std::optional<SerialItem> recognise() const;

  std::uint8_t host_;
  bool version_text_expected_ = false;
  bool program_line_expected_ = false;
  std::size_t size_ = 0;
  std::size_t bytes_before_ = 0;  ///< Of `size_`, those that came before begin_exchange().
  bool began_before_ = false;
  SerialBytes window_{};
  std::uint64_t dropped_ = 0;
};

}  // namespace tmcl
