/// Axes that were stopped, and when they stand at the latest.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "tmcl/clock.hpp"

namespace tmcld::test {

class Standing {
 public:
  /// A stop goes out. `count`: how often a program has moved it until then.
  void ask(const std::string& axis, std::int32_t count) { asked_[axis] = count; }
  /// Its module has taken the stop. A program may have moved it since that went out.
  void begin(const std::string& axis, tmcl::TimePoint at_the_latest) {
    all_[axis] = {at_the_latest, asked_[axis]};
  }
  bool empty() const { return all_.empty(); }
  /// It was sent elsewhere since, or stands.
  void end(const std::string& axis) { all_.erase(axis); }
  /// Of an axis that has to stand by now.
  std::optional<std::int32_t> count_of(const std::string& axis, tmcl::TimePoint now) const {
    const auto found = all_.find(axis);
    if (found == all_.end() || now < found->second.at_the_latest) return std::nullopt;
    return found->second.count;
  }

 private:
  struct Stopped {
    tmcl::TimePoint at_the_latest;
    std::int32_t count;
  };
  std::map<std::string, std::int32_t> asked_;
  std::map<std::string, Stopped> all_;
};

}  // namespace tmcld::test
