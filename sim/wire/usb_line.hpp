/// The USB port of one module: packets instead of bytes, and nobody else on the cable.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <span>

#include "sim/module/module.hpp"
#include "sim/wire/line.hpp"
#include "sim/wire/pace.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// As in the vendor's open firmware for the newer TMCM-1110, with a GD32: the address byte of a
/// command is ignored, and an answer has the module's own. Of a packet the first nine bytes are a
/// command, the rest is lost; a shorter packet is lost whole. A wrong checksum is answered.
///
/// An answer takes 0.25 to 2 ms, as on a bus of full speed: evenly distributed, by the seed.
class UsbLine final : public Line {
 public:
  using Output = std::function<void(std::span<const std::uint8_t>)>;

  static constexpr Duration shortest_answer = std::chrono::microseconds(250);
  static constexpr Duration longest_answer = std::chrono::milliseconds(2);

  /// The module is one of the bench. `output` gets each answer whole; it must not destroy the line.
  UsbLine(Bench& bench, Module& module, Output output, std::uint64_t seed);

  /// A packet from the host, in the instant that the bench's clock shows.
  void receive(std::span<const std::uint8_t> packet);

  TimePoint next_due() const override { return going_.next_due(); }
  void run_due() override;
  void target_reached(const Module& module, std::int32_t motors) override;

 private:
  void send(const SerialBytes& bytes);

  Module* module_;
  Output output_;
  std::mt19937_64 random_;
  Transit<SerialBytes> going_;
};

}  // namespace tmcl::sim
