/// What all ramp generators have in common.
///
/// A generator is a value: registers and the state of one axis, at one tick of its own clock.
/// Nothing happens by itself; advance_to() brings it to a later tick, through as many of them as it
/// takes, at a cost that does not depend on how many. A copy that is advanced is a prediction.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace tmcl::ramp {

/// Periods of the generator's own clock since its reset.
using Tick = std::uint64_t;
constexpr Tick forever = UINT64_MAX;
/// advance_to() goes no further; at the shortest tick in use that is nine thousand years.
constexpr Tick last_tick = Tick{1} << 62;

/// Where the chip keeps a register: at an address, that of its first motor and without the bit that
/// tells reading from writing. What takes negative values is alone there.
struct ChipBits {
  std::uint8_t address = 0;
  std::uint8_t shift = 0;
  std::uint8_t count = 0;  ///< 0: nowhere that a command reaches.

  constexpr bool are_at(std::uint8_t place) const { return count != 0 && address == place; }
};

/// A register by the name that the chip's data sheet gives it, in lower case.
struct RegisterInfo {
  std::string_view name;
  std::int64_t minimum;
  std::int64_t maximum;
  std::string_view meaning;  ///< With the unit.
  ChipBits bits{};
  /// Of its values, from the minimum on. If there are any, it takes only values that have one.
  std::span<const std::string_view> names{};

  bool takes(std::int64_t value) const;
  std::optional<std::int64_t> value_of(std::string_view value_name) const;
};

/// Why a register was not written; nothing has changed then.
struct RegisterError {
  enum class Reason : std::uint8_t {
    out_of_range,  ///< The value does not fit the register.
    in_motion,     ///< The chip takes this one at standstill only: its "command error".
  };
  Reason reason;
  const RegisterInfo* info;
  std::int64_t value;
};

/// "v_max is 0..2047, not 5000"
std::string describe(const RegisterError& error);

using Written = tl::expected<void, RegisterError>;

/// Settings that the chip takes but that do not go together: it moves, but not as one would wish,
/// and no document may say how. Always a warning: a register is written before the others are, and
/// what is wrong then may be right a moment later.
struct Finding {
  enum class Form : std::uint8_t { name, value, name_and_value };
  /// A register that the text is about. The value is one that the register could hold, and only
  /// with its name the one that it holds.
  struct Mention {
    std::size_t index;  ///< Of the generator's registers.
    std::int64_t value;
    Form form;
  };

  /// One sentence without a full stop, with a {} for each mention.
  std::string_view text;
  std::vector<Mention> mentions;
};

/// With each {} as `said` calls its mention.
std::string describe(const Finding& finding,
                     const std::function<std::string(const Finding::Mention&)>& said);
/// As the data sheet calls the registers: "vstop 10 is below vstart 50000, ...".
std::string describe(const Finding& finding, std::span<const RegisterInfo> registers);

/// All findings of a generator, by the names of its registers.
template <class G>
std::vector<std::string> warnings_of(const G& generator) {
  std::vector<std::string> warnings;
  for (const auto& finding : generator.findings())
    warnings.push_back(describe(finding, G::registers()));
  return warnings;
}

/// In the chip's units: microsteps and what its registers count velocity and acceleration in.
struct Motion {
  std::int64_t position = 0;
  std::int64_t velocity = 0;
  std::int64_t acceleration = 0;
  bool operator==(const Motion&) const = default;
};

/// G::Register is an enumeration that counts from 0 in the order of G::registers().
template <class G>
concept Generator = std::copyable<G> && std::equality_comparable<G> &&
    requires(G g, const G c, typename G::Register name, std::int64_t value, Tick tick) {
  { G::chip } -> std::convertible_to<std::string_view>;
  /// How many ticks there are in a second (MC1451A: in a cycle) at this clock in Hz.
  { G::ticks_per_second(16e6) } -> std::same_as<double>;
  { G::registers() } -> std::same_as<std::span<const RegisterInfo>>;
  { g.write(name, value) } -> std::same_as<Written>;
  { c.read(name) } -> std::same_as<std::int64_t>;
  { c.findings() } -> std::same_as<std::vector<Finding>>;

  { c.tick() } -> std::same_as<Tick>;
  /// Lets time pass. An earlier tick than the present one changes nothing.
  { g.advance_to(tick) } -> std::same_as<void>;
  { c.motion() } -> std::same_as<Motion>;
  /// The name of the present part of the movement, such as "cruise"; "rest" at standstill.
  { c.phase() } -> std::same_as<std::string_view>;
  /// The first tick to come at which the phase, a flag or the sense of the acceleration may
  /// differ from now if nothing is written until then; `forever` if none will. Not const, because
  /// it may work out the movement first.
  { g.next_change() } -> std::same_as<Tick>;
  /// Stands on its target, and stays there.
  { c.arrived() } -> std::same_as<bool>;
  /// Nothing but the position changes any more until a register is written.
  { c.settled() } -> std::same_as<bool>;
};

/// The row of this name; nothing if the chip has no such register.
std::optional<std::size_t> find_register(std::span<const RegisterInfo> registers,
                                         std::string_view name);

/// Looking ahead ends after so many changes: a generator that oscillates never comes to an end.
constexpr std::size_t most_changes_ahead = 4'000'000;

/// The generator as it will be when it arrives, settles, comes to `limit`, or has changed so often,
/// if nothing is written until then.
template <Generator G>
G look_ahead(G ahead, Tick limit, std::size_t most_changes = most_changes_ahead) {
  limit = std::min(limit, last_tick);
  for (; most_changes != 0; --most_changes) {
    // Asked first, because it works out the movement; the others would each do so again.
    const auto change = ahead.next_change();
    if (ahead.arrived() || ahead.settled() || ahead.tick() >= limit) break;
    ahead.advance_to(std::min(limit, change));
  }
  return ahead;
}

/// The tick at which it comes to stand on its target if nothing is written until then. Nothing if
/// that is after `limit`, or never.
template <Generator G>
std::optional<Tick> arrival(const G& now, Tick limit) {
  const G ahead = look_ahead(now, limit);
  if (!ahead.arrived()) return std::nullopt;
  return ahead.tick();
}

}  // namespace tmcl::ramp
