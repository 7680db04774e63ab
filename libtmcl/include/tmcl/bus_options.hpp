/// How a bus is driven, and what can be learnt about it besides answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl {

struct BusOptions {
  /// How errors name this bus; empty: the link's name.
  std::string name{};
  /// How long a module may take to answer, on top of what the wire needs. 1 ms..60 s
  Duration reply_timeout = std::chrono::milliseconds(100);
  /// The module's telegram pause time (global parameter 75); added to the reply timeout on serial
  /// lines.
  Duration telegram_pause{};
  /// Silence after an unanswered request, so that a late reply can still come and a module drops a
  /// partial datagram: those do so after 5 ms.
  Duration quiet_time = std::chrono::milliseconds(10);
  /// How long a module that did not answer is not asked again; half as long again if it stays
  /// silent. Stops still go out to it. 0..60 s
  Duration silence_time = std::chrono::milliseconds(250);
  /// How often a repeatable command is sent before it counts as failed. 1..10
  unsigned attempts = 3;
  /// First byte of the modules' serial replies (global parameter 76).
  std::uint8_t host_address = default_host_address;
};

/// How many commands of a kind (stops, what acts, reads) may wait for one bus.
constexpr std::size_t max_queued_calls = 256;

/// A hold that is not used for so long ends.
constexpr Duration hold_idle_limit = std::chrono::seconds(5);

struct BusCounters {
  std::uint64_t requests = 0;  ///< Datagrams sent.
  std::uint64_t replies = 0;   ///< Answers that were accepted.
  std::uint64_t timeouts = 0;
  std::uint64_t late_replies = 0;  ///< Answers to requests that had been given up; dropped.
  std::uint64_t unexpected_replies =
      0;  ///< Answers to nothing that was asked, or from another module; dropped.
  std::uint64_t garbage_bytes =
      0;  ///< Bytes that belonged to no datagram, wrong checksums included.
  std::uint64_t fences =
      0;  ///< Exchanges that proved, or tried to prove, that a module is in step.
  std::uint64_t surplus = 0;  ///< Replies beyond what a module was asked for.
  std::uint64_t suspect = 0;  ///< Answers that a further exchange had to prove.
};

struct BusEvent {
  enum class Kind : std::uint8_t {
    target_reached,     ///< `value` has a bit for each motor that arrived (command 138).
    duplicate_address,  ///< Foreign replies: a second module of the address, or a second host.
    link_condition,     ///< `text` says what the CAN controller reports.
    link_lost,          ///< `text` says why; nothing more comes from this bus.
  };
  Kind kind;
  ModuleAddress module{};
  std::int32_t value = 0;
  std::string text{};
};

}  // namespace tmcl
