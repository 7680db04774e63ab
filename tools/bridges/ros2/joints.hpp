/// Joints that are axes of a tmcld, without anything of ROS 2: what tmcl_system.cpp shows to that.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/client.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::ros2 {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// How many metres or radians the unit of an axis has.
tl::expected<double, std::string> si_per_unit(client::Caller& caller, const std::string& axis);

struct Choices {
  std::string socket = "/run/tmcld/tmcld.sock";
  double lease_ttl_s = 2;  ///< 1 to 60
  std::vector<std::string> axes{};
};

/// In radians or metres, and these per second.
struct Reading {
  double position = unknown;
  double velocity = unknown;
  double age_s = unknown;
};

/// Follows axes on a thread of its own, and moves them under one lease. Nothing moves at open() and
/// take(). After its first failure, the error of read() and command(), it does nothing any more:
/// destroyed, it has tmcld stop what it has moved, and another one is opened.
/// An error is a sentence.
/// Thread safety: one call at a time, from any thread.
class Joints {
 public:
  explicit Joints(Choices choices);
  /// Connects, and looks at each axis.
  tl::expected<void, std::string> open();
  /// Takes the lease. The axes have to stand: where they do is what is commanded from now on.
  tl::expected<std::vector<double>, std::string> take();
  /// Stops the axes and gives the lease back.
  tl::expected<void, std::string> give();

  /// In the order of the axes. Does not wait for tmcld: an error where nothing new is known.
  tl::expected<std::vector<Reading>, std::string> read();
  /// Where to go, in radians or metres; nan is no command. Does not wait for tmcld: the newest
  /// command counts, and a refusal is the error of the next call.
  tl::expected<void, std::string> command(std::span<const double> positions);

 private:
  struct Joint {
    std::string axis;
    double si_per_unit = 1;
    Reading reading{};
    TimePoint seen{};
    bool moving = true;
    std::uint64_t last_stop = 0;
    std::string stop_cause{};
    double wanted = unknown, sent = unknown;
  };

  tl::expected<void, std::string> look(Joint& joint, std::optional<std::uint16_t> may_be_old_ms);
  tl::expected<std::vector<double>, std::string> stand();
  tl::expected<void, std::string> send(Joint& joint);
  tl::expected<void, std::string> keep_lease();
  tl::expected<void, std::string> turn();
  void follow(const std::stop_token& ending);

  const Choices choices_;
  const RealClock clock_;
  /// For the calls; taken before `data_`, which is never held during one.
  std::mutex calls_;
  std::optional<client::Caller> caller_;
  std::optional<api::lease::OnLease> lease_;  ///< While it is active.
  TimePoint renewed_{};
  std::mutex data_;
  std::vector<Joint> joints_;
  std::string failure_;
  std::atomic<TimePoint> asked_{};  ///< When ROS 2 has commanded.
  std::condition_variable_any pause_;
  std::jthread worker_;  ///< Ends first.
};

}  // namespace tmcl::ros2
