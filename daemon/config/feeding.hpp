/// What it takes to keep modules with a deadman from stopping their motors: a command each, before
/// the time of the deadman is over.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>

#include "config/config.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcld {

constexpr std::int32_t shortest_deadman_ms = 100;
constexpr std::int32_t longest_deadman_ms = 65'535;  // of the module's parameter
/// A module is sent something so often within the time of its deadman.
constexpr int feedings_per_deadman = 3;
/// Of a wire, in percent: the rest is for movements.
constexpr int most_feeding_percent = 50;

constexpr tmcl::Duration feeding_interval(std::int32_t deadman_ms) {
  return tmcl::Duration(std::chrono::milliseconds(deadman_ms)) / feedings_per_deadman;
}

/// Empty for a time that a deadman can have; 0: it is switched off.
inline std::string fault_of_deadman(std::int32_t ms) {
  if (ms == 0 || (ms >= shortest_deadman_ms && ms <= longest_deadman_ms)) return {};
  return "is " + std::to_string(ms) + ", but must be 0 (off) or " +
         std::to_string(shortest_deadman_ms) + ".." + std::to_string(longest_deadman_ms);
}

/// How long a question and its answer keep a wire busy. It is unknown how fast a CAN interface is
/// set up, or the line behind a device server: then as in `in_words`.
struct FeedingWire {
  tmcl::Duration exchange;
  std::string in_words;
};
inline FeedingWire feeding_wire(const BusConfig& bus) {
  constexpr std::uint32_t usual_baud = 9600;
  constexpr double bits_per_byte = 10;
  constexpr double can_frame_bits = 130;
  constexpr double can_bit_rate = 125'000;
  constexpr double answering_s = 0.001;  // what a module takes to think
  const auto lasting = [](double seconds) {
    return std::chrono::duration_cast<tmcl::Duration>(
        std::chrono::duration<double>(seconds + answering_s));
  };
  constexpr double usb_turns_s = 0.002;
  if (std::holds_alternative<tmcl::UsbName>(bus.link)) return {lasting(usb_turns_s), "by USB"};
  if (std::holds_alternative<tmcl::CanName>(bus.link))
    return {lasting(2 * can_frame_bits / can_bit_rate), "if it runs at 125 kbit/s"};
  const auto* serial = std::get_if<tmcl::SerialName>(&bus.link);
  const auto baud = serial != nullptr ? serial->baud : usual_baud;
  const auto seconds = 2 * tmcl::serial_datagram_size * bits_per_byte / baud;
  return {lasting(seconds) + bus.bus_options.telegram_pause,
          (serial != nullptr ? "at " : "if it runs at ") + std::to_string(baud) + " baud"};
}

/// Of the wire of a bus: 0 where no module has a deadman.
inline double feeding_percent(const BusConfig& bus) {
  double percent = 0;
  for (const auto& module : bus.modules) {
    if (module.deadman_ms.value_or(0) > 0)
      percent += 100.0 * static_cast<double>(feeding_wire(bus).exchange.count()) /
                 static_cast<double>(feeding_interval(*module.deadman_ms).count());
  }
  return percent;
}

/// Why the modules of a bus cannot be fed; empty if they can.
inline std::string fault_of_feeding(const BusConfig& bus) {
  const auto percent = feeding_percent(bus);
  if (percent <= most_feeding_percent) return {};
  return "takes " + std::to_string(std::lround(percent)) + " % of bus '" + bus.name + "' " +
         feeding_wire(bus).in_words +
         ", as its modules must be sent something in every third of that time: more than " +
         std::to_string(most_feeding_percent) + " %. Make it longer, or the line faster";
}

/// The shortest deadman with which an answer that gets lost is made up for in time: the question is
/// asked again after its time is over, and all other modules may have their turn before that.
inline std::chrono::milliseconds shortest_steady_deadman(const BusConfig& bus) {
  tmcl::Duration lost = bus.bus_options.reply_timeout + bus.bus_options.quiet_time;
  for (const auto& module : bus.modules)
    if (module.deadman_ms.value_or(0) > 0) lost += feeding_wire(bus).exchange;
  constexpr int rest_of_deadman = feedings_per_deadman - 1;
  return std::chrono::ceil<std::chrono::milliseconds>(lost * feedings_per_deadman /
                                                      rest_of_deadman);
}

}  // namespace tmcld
