/// The USB port of one module: packets instead of bytes, and no other module on the cable.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "sim/module/module.hpp"
#include "sim/wire/line.hpp"
#include "sim/wire/pace.hpp"
#include "sim/wire/usb_layout.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// As in the vendor's open firmware for the TMCM-1110: the address byte of a command is ignored,
/// and an answer has the module's own. A wrong checksum is answered. Of a packet the first nine
/// bytes are a command, the rest is lost; a shorter packet is lost whole by newer modules, with a
/// GD32. Older ones, with an MK20, keep it until there are nine bytes.
///
/// An answer takes 0.25 to 2 ms, as on a bus of full speed: evenly distributed, by the seed.
class UsbLine final : public Line {
 public:
  using Output = std::function<void(std::span<const std::uint8_t>)>;

  static constexpr Duration shortest_answer = std::chrono::microseconds(250);
  static constexpr Duration longest_answer = std::chrono::milliseconds(2);

  /// The module is one of the bench. `output` gets each answer whole; it must not destroy the line.
  UsbLine(Bench& bench, Module& module, Output output, std::uint64_t seed,
          UsbLayout layout = UsbLayout::gd32);

  /// A packet from the host, in the instant that the bench's clock shows.
  void receive(std::span<const std::uint8_t> packet);

  TimePoint next_due() const override { return going_.next_due(); }
  void run_due() override;
  void target_reached(const Module& module, std::int32_t motors) override;

 private:
  void execute(const SerialBytes& frame);
  void send(const SerialBytes& bytes);

  Module* module_;
  Output output_;
  std::mt19937_64 random_;
  bool keeps_short_packets_;
  std::vector<std::uint8_t> heard_;
  Transit<SerialBytes> going_;
};

}  // namespace tmcl::sim
