/// What command 142, RAMDebug, sets up and reads: a record of a module's values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim/module/answer.hpp"
#include "sim/module/tick_clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/model.hpp"
#include "tmcl/ram_debug.hpp"

namespace tmcl::sim {

/// Whether a module of this family has one if nothing else is said. No public document says which
/// modules have command 142.
constexpr bool has_data_logger(Family family) {
  return family == Family::sixpoint || family == Family::tmc4361;
}

/// Answers as the firmware of the vendor's evaluation boards does (TMC-EvalSystem, tmc/RAMDebug.c
/// and handleRamDebug() in tmc/TMCL.c), and records as that does: at each tick of the base
/// frequency it looks at the trigger, and at every so many of them it writes one value of each
/// channel, one behind the other, into a ring.
class DataLogger {
 public:
  static constexpr std::size_t channel_count = 4;          ///< As the TMCM-1617 has.
  static constexpr std::uint32_t elements = 8192;          ///< As that and the boards have.
  static constexpr std::uint32_t ticks_per_second = 1000;  ///< As most of the boards.

  struct Channel {
    ram_debug::Kind kind = ram_debug::Kind::off;
    std::uint32_t select = 0;
    bool operator==(const Channel&) const = default;
  };
  /// What a channel reads now; never asked for one that is off.
  using Probe = std::function<std::uint32_t(const Channel&)>;

  explicit DataLogger(TimePoint power_on)
      : power_on_(power_on), clock_(power_on, ticks_per_second) {}

  TimePoint power_on() const { return power_on_; }

  /// Every refusal repeats the request's value.
  Answer execute(const Request& request, TimePoint now, const Probe& probe);

  /// Its next tick while it records or waits for its trigger; otherwise `never`.
  TimePoint next_due() const { return is_running() ? clock_.of(next_tick_) : never; }
  void run_due(TimePoint now, const Probe& probe);

 private:
  using Reading = std::optional<std::uint32_t>;

  bool is_idle() const { return state_ == ram_debug::State::idle; }
  bool is_running() const { return !is_idle() && state_ != ram_debug::State::complete; }
  void init();
  Answer change(const Request& request, TimePoint now, const Probe& probe);
  Answer read(const Request& request) const;
  Reading sample(std::uint32_t index) const;
  Reading info(std::uint32_t number) const;
  const Channel* channel(std::uint8_t index) const;

  Channel* free_channel();
  bool set_channel(std::uint8_t kind, std::uint32_t select);
  bool set_kind(std::uint32_t kind);
  bool set_select(std::uint32_t select);
  bool set_trigger_channel(std::uint8_t kind, std::uint32_t select);
  bool set_trigger_kind(std::uint32_t kind);
  bool set_trigger_select(std::uint32_t select);
  void enable(std::uint8_t trigger, std::uint32_t threshold, TimePoint now, const Probe& probe);

  struct Above {
    bool as_signed = false;
    bool as_unsigned = false;
  };
  Above look(const Probe& probe) const;
  bool is_met(Above before, Above after) const;
  void tick(const Probe& probe);
  void write_samples(const Probe& probe);
  /// Values in the ring since the record began.
  std::uint32_t recorded() const { return (write_index_ - start_index_) % elements; }

  TimePoint power_on_;
  TickClock clock_;
  ramp::Tick next_tick_ = 0;
  ram_debug::State state_ = ram_debug::State::idle;
  std::vector<std::uint32_t> ring_ = std::vector<std::uint32_t>(elements);
  std::uint32_t write_index_ = 0;
  std::uint32_t start_index_ = 0;
  std::uint32_t divider_ = 1;
  std::uint32_t ticks_ = 0;  // since the last samples
  std::uint32_t sample_count_ = elements;
  std::uint32_t pretrigger_count_ = 0;
  std::array<Channel, channel_count> channels_{};
  Channel trigger_channel_;
  ram_debug::Trigger trigger_ = ram_debug::Trigger::unconditional;
  std::uint32_t threshold_ = 0;
  std::uint32_t mask_ = UINT32_MAX;
  std::uint8_t shift_ = 0;
  Above above_;
};

}  // namespace tmcl::sim
