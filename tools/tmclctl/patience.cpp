#include "patience.hpp"

#include <poll.h>

#include <algorithm>
#include <csignal>

namespace tmclctl {
namespace {

volatile std::sig_atomic_t caught_signal = 0;

void note_signal(int number) { caught_signal = number; }

// A signal that comes just before the sleep begins is noticed after so long at the latest.
constexpr auto longest_sleep = std::chrono::milliseconds(100);

}  // namespace

void RealPatience::catch_signals() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

void RealPatience::sleep(tmcl::Duration duration) {
  const auto until = now() + duration;
  while (signal() == 0) {
    const auto left = until - now();
    if (left <= tmcl::Duration::zero()) return;
    const auto slice =
        std::chrono::ceil<std::chrono::milliseconds>(std::min<tmcl::Duration>(left, longest_sleep));
    ::poll(nullptr, 0, static_cast<int>(slice.count()));
  }
}

int RealPatience::signal() const { return caught_signal; }

}  // namespace tmclctl
