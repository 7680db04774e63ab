/// Whether a line is silent while a datagram on it is not whole.
///
/// When bytes are read says little about when they came: on a busy computer the simulator may not
/// have been running meanwhile. So silence is what was looked for and seen.
#pragma once

#include <memory>

#include <poll.h>

#include <boost/asio/io_context.hpp>

#include "sim/wire/serial_framer.hpp"
#include "tmcl/timer.hpp"

namespace tmcl::sim {

class Silence {
 public:
  Silence(boost::asio::io_context& io, int descriptor)
      : clock_(io), timer_(io.get_executor()), descriptor_(descriptor) {}

  /// The line was silent then, and what is read next came later.
  TimePoint seen_at() const { return *seen_at_; }

  /// Looks whether something has come, once it would be too late for the same datagram.
  void look_later() {
    constexpr auto just_too_late = SerialFramer::longest_gap + std::chrono::microseconds(1);
    timer_.expires_after(just_too_late);
    // It may be called when the line is gone already.
    timer_.async_wait(
        [seen_at = seen_at_, clock = clock_, descriptor = descriptor_](const auto& error) {
          if (!error && !has_bytes(descriptor)) *seen_at = clock.now();
        });
  }

 private:
  static bool has_bytes(int descriptor) {
    pollfd entry{descriptor, POLLIN, 0};
    return ::poll(&entry, 1, 0) > 0;
  }

  ContextClock clock_;
  Timer timer_;
  int descriptor_;
  std::shared_ptr<TimePoint> seen_at_ = std::make_shared<TimePoint>();
};

}  // namespace tmcl::sim
