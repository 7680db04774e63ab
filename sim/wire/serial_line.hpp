/// A serial line (RS485, RS232, USB, raw TCP) with modules on it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/module/module.hpp"
#include "sim/wire/ascii_terminal.hpp"
#include "sim/wire/line.hpp"
#include "sim/wire/serial_framer.hpp"
#include "sim/wire/serial_wire.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// Every module hears every request, and those whose address it carries execute it; they do not
/// hear each other's replies. A module answers to its address (global parameter 66) and obeys its
/// secondary one (87, unless 0) in silence. A wrong checksum is answered by the module addressed.
///
/// A reply is that of the module as it was asked: after SGP 66 or 76 it still carries the old
/// address, and the next request must use the new one.
///
/// A module in ASCII mode hears characters and answers with lines (tmcl/ascii.hpp), as a person in
/// a terminal likes it; the others go on with datagrams.
class SerialLine final : public Line {
 public:
  using Output = std::function<void(std::span<const std::uint8_t>)>;

  /// `output` gets each reply whole, and must not destroy the line. With a pace, requests and
  /// replies are heard when their last byte has come, and each direction has a wire of its own.
  /// Modules that speak at the same time then make garbage together.
  SerialLine(Bench& bench, Output output, const SerialWire& wire = {});

  /// The host speaks and hears at another rate from now on. Only with a pace.
  void set_host_rate(std::uint32_t bits_per_second) {
    wire_.pace.bits_per_second = bits_per_second;
  }

  /// Bytes from the host, in the instant that the bench's clock shows.
  void receive(std::span<const std::uint8_t> bytes);
  /// Bytes that have come since `earliest`, together.
  void receive(std::span<const std::uint8_t> bytes, TimePoint earliest);
  /// A module has heard a part of a datagram.
  bool is_unfinished() const;

  TimePoint next_due() const override;
  void run_due() override;
  void target_reached(const Module& module, std::int32_t motors) override;

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct Delayed {
    TimePoint at;
    Bytes bytes;
    const Module* speaker = nullptr;  ///< Null: the host.
  };
  struct Said {
    Bytes bytes;
    const Module* speaker;
  };
  /// What a module has heard of something unfinished.
  struct Ear {
    SerialFramer framer;
    AsciiTerminal terminal;
    bool ascii = false;
  };

  void hear(Bytes bytes, TimePoint earliest);
  void hear(Module& module, Ear& ear, std::uint8_t byte, TimePoint earliest);
  void hear_character(Module& module, Ear& ear, std::uint8_t byte);
  void hand_to(Module& module, const SerialBytes& frame);
  void hand_to(Module& module, const std::string& line);
  Answer execute(Module& module, const ascii::Order& order);
  void send(const Module& module, Bytes bytes);
  void say(Said said);
  bool is_at_rate_of_host(const Module& module) const;

  Output output_;
  SerialWire wire_;
  Disturbance disturbance_;
  std::vector<Ear> ears_;  ///< Of the bench's modules, in their order.
  std::deque<Delayed> delayed_;
  Transit<Delayed> coming_;  ///< Requests, and since when they can have come.
  Transit<Said> going_;
};

}  // namespace tmcl::sim
