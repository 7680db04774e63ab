/// Axes whose modules have started again, and who has said since that they may move.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "sim/module/module.hpp"
#include "tmcl/clock.hpp"

namespace tmcld::test {

class Restarts {
 public:
  /// The supply of the axis's module has failed, and is back. `watched_by`: what could tell it.
  void note(const std::string& axis, tmcl::TimePoint now, const std::string& watched_by) {
    const bool is_known = watched_by != "none" || is_latched(axis);
    all_[axis] = {now, is_known, watched_by == "settings", {}};
  }
  /// The axis is sent somewhere before anybody has looked: now its target tells nothing any more.
  void hide(const std::string& axis) {
    const auto found = all_.find(axis);
    if (found != all_.end() && found->second.is_by_target) found->second.is_known = false;
  }
  /// This call says that the axis may move.
  void allow(const std::string& axis, std::uint64_t call) {
    const auto found = all_.find(axis);
    if (found != all_.end()) found->second.allowed_by.insert(call);
  }
  /// It did not come to that.
  void withdraw(const std::string& axis, std::uint64_t call) {
    const auto found = all_.find(axis);
    if (found != all_.end()) found->second.allowed_by.erase(call);
  }
  /// Something that goes out to it now is not heard.
  bool is_deaf(const std::string& axis, tmcl::TimePoint now) const {
    // A request takes less than that on the wires of a world.
    constexpr auto on_the_wire = std::chrono::milliseconds(1);
    const auto found = all_.find(axis);
    return found != all_.end() &&
           now + on_the_wire < found->second.at + tmcl::sim::Module::boot_time;
  }
  /// Nobody has said yet that it may move.
  bool is_latched(const std::string& axis) const {
    const auto found = all_.find(axis);
    return found != all_.end() && found->second.is_known && found->second.allowed_by.empty();
  }
  /// When its module started last.
  tmcl::TimePoint last(const std::string& axis) const {
    const auto found = all_.find(axis);
    return found == all_.end() ? tmcl::TimePoint{} : found->second.at;
  }

 private:
  struct Restart {
    tmcl::TimePoint at;
    bool is_known;
    bool is_by_target;
    std::set<std::uint64_t> allowed_by;
  };
  std::map<std::string, Restart> all_;
};

}  // namespace tmcld::test
