/// tmcld as a service: who started it is told how it is, and may have opened its socket already.
/// The interfaces of sd_notify(3), sd_watchdog_enabled(3) and sd_listen_fds(3), which systemd has
/// and others have taken over; they are a datagram and some variables of the environment.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

#include "tmcl/clock.hpp"

namespace tmcld {

/// Move-only. Made by default it serves no manager: all reports are dropped.
class Service {
 public:
  /// Errors: a sentence for a person, about sockets that cannot be served.
  static tl::expected<Service, std::string> of_environment();

  Service() = default;
  Service(Service&& other) noexcept;
  Service& operator=(Service&& other) noexcept;
  ~Service();

  /// Whether a manager wants reports.
  bool is_watched() const { return descriptor_ >= 0; }
  /// How often alive() is expected at least, with a margin; a second if it is not expected.
  tmcl::Duration report_interval() const;

  /// Clients are served from now on. Waits until that is told: nothing moves yet.
  void ready(const std::string& status) const { tell("READY=1\nSTATUS=" + status, Wait::yes); }
  void stopping(const std::string& status) const { tell("STOPPING=1\nSTATUS=" + status, Wait::no); }
  /// One line for a person.
  void status(const std::string& text) const { tell("STATUS=" + text, Wait::no); }
  /// The reactor turns. Without a watchdog it does nothing.
  void alive() const;

  /// A unix socket that listens; its taker closes it. Nothing if none was passed.
  std::optional<int> take_socket() { return std::exchange(socket_, std::nullopt); }

 private:
  enum class Wait : bool { no, yes };
  void tell(const std::string& state, Wait wait) const;

  std::string address_;  ///< As the kernel has it: of an abstract one the first byte is zero.
  int descriptor_ = -1;
  tmcl::Duration watchdog_{};  ///< Zero: no watchdog waits for alive().
  std::optional<int> socket_;
};

}  // namespace tmcld
