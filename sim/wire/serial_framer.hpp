/// The receiving half of a module's serial port: cuts the stream into datagrams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// Nine bytes make a datagram, whatever they are. The only way back into step is silence: a byte
/// that comes more than 5 ms after the one before it begins a new datagram (vendor's open
/// firmware).
class SerialFramer {
 public:
  static constexpr Duration longest_gap = std::chrono::milliseconds(5);

  /// The byte came between these two times.
  std::optional<SerialBytes> push(std::uint8_t byte, TimePoint earliest, TimePoint latest) {
    if (earliest - last_ > longest_gap) size_ = 0;
    last_ = latest;
    bytes_[size_++] = byte;
    if (size_ < bytes_.size()) return std::nullopt;
    size_ = 0;
    return bytes_;
  }

  /// Some bytes of a datagram are there.
  bool has_begun() const { return size_ != 0; }

 private:
  SerialBytes bytes_{};
  std::size_t size_ = 0;
  TimePoint last_{};
};

}  // namespace tmcl::sim
