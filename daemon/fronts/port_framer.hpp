/// Cuts what a host says into datagrams, as a module does.
#pragma once

#include <chrono>
#include <cstddef>
#include <span>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcld {

/// Nine bytes make a datagram, whatever they are. Only silence brings it back into step: what
/// has begun is dropped when no more comes for longest_gap.
class PortFramer {
 public:
  static constexpr tmcl::Duration longest_gap = std::chrono::milliseconds(5);

  template <class OnDatagram>
  void push(std::span<const std::uint8_t> bytes, OnDatagram on_datagram) {
    for (const auto byte : bytes) {
      bytes_[size_++] = byte;
      if (size_ < bytes_.size()) continue;
      size_ = 0;
      on_datagram(bytes_);
    }
  }
  bool has_begun() const { return size_ != 0; }
  void drop() { size_ = 0; }

 private:
  tmcl::SerialBytes bytes_{};
  std::size_t size_ = 0;
};

}  // namespace tmcld
