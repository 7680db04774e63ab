/// Simulated modules in virtual time, for fuzz targets.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "require.hpp"
#include "sim/bench.hpp"
#include "sim/wire/can_line.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/model.hpp"

namespace tmcl::fuzz {

class Bench {
 public:
  /// The first module has the address 1, the next 2.
  explicit Bench(std::initializer_list<std::uint16_t> models) {
    std::uint16_t address = 0;
    for (const auto model : models) bench.add(*find_model(model), ModuleAddress{++address});
  }

  /// However little happens in it, this much time has an end.
  void pass(Duration duration) {
    constexpr std::size_t most_turns = 100'000;
    const auto until = clock.now() + duration;
    std::size_t turns = 0;
    bench.run_due();
    for (auto due = bench.next_due(); due <= until; due = bench.next_due()) {
      require(++turns < most_turns, "time goes on");
      clock.advance_to(std::max(due, clock.now()));
      bench.run_due();
    }
    clock.advance_to(until);
    bench.run_due();
  }

  VirtualClock clock;
  sim::Bench bench{clock};
  std::vector<std::uint8_t> sent;
  std::vector<CanFrame> frames;
  sim::SerialLine line{bench, [this](std::span<const std::uint8_t> bytes) {
                         sent.insert(sent.end(), bytes.begin(), bytes.end());
                       }};
  sim::CanLine can{bench, [this](const CanFrame& frame) { frames.push_back(frame); }};
};

}  // namespace tmcl::fuzz
