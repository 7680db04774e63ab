/// Stops that were asked for and that no module has answered: its link was away, or it was silent.
/// They are sent when the module can be reached again, before anything else moves there.
///
/// Does no I/O. Thread safety: none. Bounded.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/command.hpp"
#include "tmcl/intent.hpp"

namespace tmcld {

class OwedStops {
 public:
  /// More than the motors of all modules that a bus has in practice.
  static constexpr std::size_t most = 256;

  /// False if there is no room for it.
  bool add(const tmcl::Request& stop) {
    if (has(stop)) return true;
    if (stops_.size() == most) return false;
    stops_.push_back(key_of(stop));
    return true;
  }
  /// Its module has answered it.
  void remove(const tmcl::Request& stop) { std::erase(stops_, key_of(stop)); }
  bool has(const tmcl::Request& stop) const {
    return std::ranges::find(stops_, key_of(stop)) != stops_.end();
  }
  bool has(tmcl::AxisAddress motor) const {
    return std::ranges::any_of(stops_, [&](const tmcl::Request& stop) {
      return stop.address == motor.module && stop.motor == motor.motor;
    });
  }
  /// In the order in which they were asked for; the end of a program behind those of motors.
  std::vector<tmcl::Request> of(tmcl::ModuleAddress module) const {
    std::vector<tmcl::Request> stops;
    std::ranges::copy_if(stops_, std::back_inserter(stops),
                         [&](const tmcl::Request& stop) { return stop.address == module; });
    std::ranges::stable_partition(stops,
                                  [](const tmcl::Request& stop) { return !ends_program(stop); });
    return stops;
  }
  static bool ends_program(const tmcl::Request& stop) {
    return intent_of(stop).motion == tmcl::Motion::ends_program;
  }
  std::vector<tmcl::ModuleAddress> modules() const {
    std::vector<tmcl::ModuleAddress> modules;
    for (const auto& stop : stops_)
      if (std::ranges::find(modules, stop.address) == modules.end())
        modules.push_back(stop.address);
    return modules;
  }

 private:
  /// The value of a stop means nothing.
  static tmcl::Request key_of(tmcl::Request stop) {
    stop.value = 0;
    return stop;
  }

  std::vector<tmcl::Request> stops_;
};

/// What the answer to such a stop says.
constexpr std::string_view owed_stop_hint =
    "the stop is sent as soon as the module can be reached, before anything else moves there";

}  // namespace tmcld
