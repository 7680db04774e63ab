/// A module with a deadman: it is set once, gets a command in time as long as anybody can send it
/// one, and stands when it has had none for too long.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld::test {

class Feeding {
 public:
  static constexpr std::int32_t deadman_ms = 600;
  static constexpr tmcl::Duration deadman = std::chrono::milliseconds(deadman_ms);
  /// From the greatest speed that anybody asks for in a world, by the acceleration of its motors.
  static constexpr tmcl::Duration time_to_ramp_down = std::chrono::milliseconds(100);

  Feeding(std::string bus, tmcl::ModuleAddress module) : bus_(std::move(bus)), module_(module) {}

  bool is_of(const std::string& bus, tmcl::ModuleAddress module) const {
    return bus == bus_ && module == module_;
  }
  /// In the order in which they are on the wire. Gives what is wrong with it; empty if nothing is.
  std::string on_request(const std::string& bus, const tmcl::Request& request,
                         tmcl::TimePoint now) {
    if (request.command == tmcl::Command::SGP) {
      const bool sets = is_of(bus, request.address) &&
                        request.type == tmcl::global_parameter::can_heartbeat &&
                        request.value == deadman_ms;
      if (!sets || std::exchange(is_set_, true)) return "a setting is written to an EEPROM";
    }
    if (!is_of(bus, request.address)) return {};
    sent_ = now;
    const auto before = std::exchange(last_, now);
    const bool is_late = before && now - *before > deadman;
    return is_late ? "a module with a deadman got no command for too long" : std::string();
  }
  /// Until now nobody could send it anything, or it could hear nothing.
  void on_pause(tmcl::TimePoint now) {
    if (last_) last_ = now;
  }
  /// `own_ramp`: how long its motor takes to rest by the settings that it has, which a line may
  /// have lowered.
  bool must_stand(tmcl::TimePoint now, tmcl::Duration own_ramp) const {
    return has_passed(last_, now, own_ramp);
  }
  /// Its deadman has stopped it, whether that could be helped or not.
  bool has_stopped(tmcl::TimePoint now, tmcl::Duration own_ramp) const {
    return has_passed(sent_, now, own_ramp);
  }

 private:
  static bool has_passed(std::optional<tmcl::TimePoint> since, tmcl::TimePoint now,
                         tmcl::Duration own_ramp) {
    return since && now - *since > deadman + std::max(time_to_ramp_down, own_ramp);
  }

  std::string bus_;
  tmcl::ModuleAddress module_;
  bool is_set_ = false;
  std::optional<tmcl::TimePoint> sent_;  ///< When it was sent something last.
  std::optional<tmcl::TimePoint> last_;  ///< The same, or when it could hear something again.
};

}  // namespace tmcld::test
