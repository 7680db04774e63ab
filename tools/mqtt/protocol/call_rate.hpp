/// How often a user may call: more costs this program no work, and other users nothing. Does no
/// I/O, reads no clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "tmcl/clock.hpp"

namespace tmclmqtt {

class CallRate {
 public:
  static constexpr double calls_per_second = 50;
  static constexpr double most_at_once = 100;
  static constexpr std::size_t most_users = 64;
  /// A user who calls more often is told so at this interval at most.
  static constexpr tmcl::Duration telling_interval = std::chrono::seconds(1);

  enum class Verdict : std::uint8_t { pass, refuse, drop };

  Verdict judge(const std::string& user, tmcl::TimePoint now);

 private:
  struct Allowance {
    double left = most_at_once;
    tmcl::TimePoint counted{};
    std::optional<tmcl::TimePoint> told{};
  };

  Allowance& allowance_of(const std::string& user, tmcl::TimePoint now);

  std::map<std::string, Allowance> users_;
};

}  // namespace tmclmqtt
