/// Interrupts of a stand-alone program: which are on, where they go, which of them have happened.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "sim/program/host.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::sim {

/// Numbers, for EI, DI and VECT; those of the TMCM-6110 firmware manual.
namespace interrupt {
constexpr std::uint8_t timer = 0;            ///< And the two after it.
constexpr std::uint8_t target_reached = 3;   ///< Motor 0; motor 1 has the next, and so on.
constexpr std::uint8_t stall = 15;           ///< The same.
constexpr std::uint8_t deviation = 21;       ///< The same.
constexpr std::uint8_t stop_left = 27;       ///< Motor 0, and 28 its right one; then motor 1's.
constexpr std::uint8_t input = 39;           ///< Input 0; input 1 has the next, and so on.
constexpr std::uint8_t global_enable = 255;  ///< For EI and DI only: all of them.
}  // namespace interrupt

/// An interrupt that is on is noted once it happens, and stays noted until its routine begins. What
/// happened before it was switched on does not count, and happening twice is happening once. The
/// least number goes first. All this is our reading: the manuals tell only the commands.
class Interrupts {
 public:
  explicit Interrupts(const ProgramHost& host) : host_(&host) {}

  /// Everything off, no vectors.
  void reset() { *this = Interrupts(*host_); }

  /// Whether this module has it.
  bool exists(std::uint8_t number) const;
  /// One that exists, or global_enable. A timer's period begins now.
  void enable(std::uint8_t number, TimePoint now);
  void disable(std::uint8_t number);
  /// Where the routine of one that exists begins. Without this it is never called.
  void set_vector(std::uint8_t number, std::uint16_t address) { sources_[number].vector = address; }

  /// Takes note of what has happened since the last time.
  void observe(TimePoint now);
  /// The routine to run now, if any: its interrupt is not noted any more.
  std::optional<std::uint16_t> take();

  /// Whether any condition of the module matters.
  bool listening() const;
  /// When the next timer runs out, as things are.
  TimePoint next_due() const;

 private:
  enum class Kind : std::uint8_t { timer, target_reached, stall, deviation, left, right, input };
  struct Place {
    Kind kind;
    std::size_t index;
  };
  struct Source {
    bool enabled = false;
    bool pending = false;
    bool level = false;
    TimePoint begun{};  // of a timer's period
    std::optional<std::uint16_t> vector;
  };

  std::optional<Place> place_of(std::uint8_t number) const;
  bool level_of(Place place) const;
  bool is_edge(Kind kind, std::uint8_t number, bool level) const;
  void observe(std::uint8_t number, Source& source, TimePoint now) const;
  void observe_timer(std::uint8_t number, Source& source, TimePoint now) const;
  Duration period(std::uint8_t timer) const;

  const ProgramHost* host_;
  bool enabled_ = false;
  std::map<std::uint8_t, Source> sources_;  // those that a program has named
};

}  // namespace tmcl::sim
