/// Bytes as a script of register writes and waiting times for a ramp generator.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "tmcl/ramp/generator.hpp"

namespace tmcl::test {

/// Numbers out of bytes; zeros when these are used up.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  bool empty() const { return left_.empty(); }
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const auto first = left_.front();
    left_ = left_.subspan(1);
    return first;
  }
  /// Of any size: the first byte says how many bits it has.
  std::uint64_t number() {
    const unsigned bits = byte() % 65U;
    std::uint64_t value = 0;
    for (unsigned i = 0; i < (bits + 7) / 8; ++i) value = value << 8U | byte();
    return bits == 64 ? value : value & ((std::uint64_t{1} << bits) - 1);
  }

 private:
  std::span<const std::uint8_t> left_;
};

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

/// Runs the script and aborts if what must hold for every generator does not.
template <ramp::Generator G>
class RampScript {
 public:
  explicit RampScript(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  void run() {
    while (!bytes_.empty()) {
      const auto what = bytes_.byte();
      if (what < 160) {
        write(what % G::registers().size());
      } else {
        wait();
      }
      look();
    }
  }

 private:
  void write(std::size_t index) {
    const auto& info = G::registers()[index];
    const auto name = static_cast<typename G::Register>(index);
    const bool wild = bytes_.byte() % 8 == 0;
    const auto number = bytes_.number();
    const auto span = static_cast<std::uint64_t>(info.maximum - info.minimum) + 1;
    const auto value = wild ? static_cast<std::int64_t>(number)
                            : info.minimum + static_cast<std::int64_t>(number % span);
    const G before = axis_;
    const auto written = axis_.write(name, value);
    if (!written) require(axis_ == before, "a refused write changes nothing");
    const bool fits = value >= info.minimum && value <= info.maximum;
    if (!fits) require(!written, "a value out of range is refused");
    const auto read = axis_.read(name);
    require(read >= info.minimum && read <= info.maximum, "a register reads within its range");
  }

  // Cutting the time in two makes no difference. Only a movement that comes to an end, or settles,
  // may take any time: one that swings for ever costs what it does.
  void wait() {
    constexpr ramp::Tick swinging_for = 1'000'000;
    constexpr std::size_t changes = 200;
    const auto ahead = look_ahead(axis_, ramp::last_tick, changes);
    const bool ends = ahead.arrived() || ahead.settled();
    const auto limit = ends ? ramp::last_tick : axis_.tick() + swinging_for;
    const auto left = std::min(limit, ramp::last_tick) - axis_.tick();
    const auto ticks = std::min(left, bytes_.number());
    const auto until = axis_.tick() + ticks;
    auto in_two = axis_;
    axis_.advance_to(until);
    require(axis_.tick() == until, "time comes to where it was sent");
    in_two.advance_to(in_two.tick() + ticks * bytes_.byte() / 256);
    in_two.advance_to(until);
    require(in_two == axis_, "two advances equal one");
    if (ahead.arrived() && until >= ahead.tick()) {
      require(axis_.arrived() && axis_.motion().position == ahead.motion().position,
              "it stands where it was foreseen");
    }
  }

  void look() {
    require(!axis_.phase().empty(), "every phase has a name");
    (void)axis_.findings();
    (void)axis_.motion();
    require(axis_.next_change() > axis_.tick(), "a change is still to come");
  }

  Bytes bytes_;
  G axis_;
};

}  // namespace tmcl::test

/// The one function of a fuzz target.
#define TMCL_FUZZ_RAMP(generator)                                                     \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    tmcl::test::RampScript<tmcl::ramp::generator>(std::span(data, size)).run();       \
    return 0;                                                                         \
  }
