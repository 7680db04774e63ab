/// Serial lines on which every request comes back, as with RS485 adapters that hear themselves.
#pragma once

#include <span>

#include "tmcl/datagram.hpp"

namespace tmcl::engine {

/// Takes a request that comes back out of what a line brings. No reply looks like the request that
/// it answers: it has a status where that has a type, and begins with the host's address.
class LineEcho {
 public:
  /// This goes out now.
  void begin(const Request& sent) {
    expected_ = encode_serial(sent);
    seen_ = 0;
    expects_ = true;
  }
  /// What is left of the bytes that came so far when this one has come; valid until the next one.
  std::span<const std::uint8_t> pass(const std::uint8_t& byte) {
    if (!expects_) return {&byte, 1};
    held_[seen_] = byte;
    expects_ = byte == expected_[seen_++];
    if (!expects_) return std::span(held_).first(seen_);
    if (seen_ < expected_.size()) return {};
    expects_ = false;
    ++echoes_;
    return {};
  }
  /// Requests that came back.
  unsigned echoes() const { return echoes_; }

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  SerialBytes expected_{};
  SerialBytes held_{};
  std::size_t seen_ = 0;
  bool expects_ = false;
  unsigned echoes_ = 0;
};

}  // namespace tmcl::engine
