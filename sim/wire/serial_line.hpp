/// A serial line (RS485, RS232, USB, raw TCP) with modules on it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>

#include "sim/module/module.hpp"
#include "sim/wire/line.hpp"
#include "sim/wire/serial_framer.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// Every module hears every request, and those whose address it carries execute it; they do not
/// hear each other's replies. A module answers to its address (global parameter 66) and obeys its
/// secondary one (87, unless 0) in silence. A wrong checksum is answered by the module addressed.
///
/// A reply is that of the module as it was asked: after SGP 66 or 76 it still carries the old
/// address, and the next request must use the new one.
class SerialLine final : public Line {
 public:
  using Output = std::function<void(std::span<const std::uint8_t>)>;

  /// `output` gets each reply whole, and must not destroy the line.
  SerialLine(Bench& bench, Output output);

  /// Bytes from the host, in the instant that the bench's clock shows.
  void receive(std::span<const std::uint8_t> bytes);

  TimePoint next_due() const override;
  void run_due() override;
  void target_reached(const Module& module, std::int32_t motors) override;

 private:
  struct Delayed {
    TimePoint at;
    SerialBytes bytes;
  };

  void deliver(const SerialBytes& frame);
  void hand_to(Module& module, const SerialBytes& frame);
  void send(const Module& module, const SerialBytes& bytes);

  Output output_;
  SerialFramer framer_;
  std::deque<Delayed> delayed_;
};

}  // namespace tmcl::sim
