/// In what a module may differ from others of its model, or what no document settles: each has a
/// few known variants, and a measurement on the module can tell which it is.
///
/// A simulated module takes them, so that it is like that one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "tmcl/model.hpp"
#include "tmcl/ramp/tmc429.hpp"

namespace tmcl {

/// The words of each are its variants, in the order of the enumeration that is named here.
enum class Trait : std::uint8_t {
  last_step,        ///< ramp::Tmc429::LastStep
  factor_rule,      ///< ramp::Tmc429::FactorRule
  order,            ///< ramp::Tmc429::Order
  accumulator,      ///< ramp::Tmc429::Accumulator
  relative_from,    ///< RelativeFrom
  relative_answer,  ///< RelativeAnswer
  velocity_target,  ///< VelocityTarget
  limit_stop,       ///< LimitStop
  program_state,    ///< ProgramState
  heartbeat,        ///< Heartbeat
  range_check,      ///< RangeCheck
  addressing,       ///< Addressing
};
constexpr std::size_t trait_count = 12;

/// What MVP REL adds its distance to.
enum class RelativeFrom : std::uint8_t { actual, target };
/// What MVP REL is answered with.
enum class RelativeAnswer : std::uint8_t { distance, target };
/// What becomes of a motor that turns by velocity when its target position is set (parameter 0).
enum class VelocityTarget : std::uint8_t { turns_on, goes_there };
/// How a motor stops at a limit switch.
enum class LimitStop : std::uint8_t {
  as_set,  ///< At once, or by its ramp where the soft stop parameter is set.
  hard,    ///< At once, whatever that says.
  soft,    ///< By its ramp, whatever that says.
};
/// Where command 135 has the state of the program.
enum class ProgramState : std::uint8_t { high_byte, low_byte };
/// What motors do when no host has sent anything for as long as global parameter 68 says.
enum class Heartbeat : std::uint8_t { stops, ignored };
/// What becomes of values that are out of range.
enum class RangeCheck : std::uint8_t {
  manual,  ///< They are refused.
  wrap,    ///< They are cut to the width of what they are written to, where that is known.
};
/// Which commands a module takes for its own.
enum class Addressing : std::uint8_t { own, any };

struct TraitInfo {
  Trait trait;
  std::string_view name;
  std::span<const std::string_view> variants;
};
/// In the order of the enumeration.
std::span<const TraitInfo, trait_count> trait_table();
/// Which variant a word is; the error says what it may be, and which word is the nearest: "is
/// 'wrapp', but must be manual or wrap. Did you mean 'wrap'?".
tl::expected<std::uint8_t, std::string> parse_variant(const TraitInfo& info, std::string_view word);
template <class Variant>
constexpr std::uint8_t index_of(Variant variant) {
  return static_cast<std::uint8_t>(variant);
}
/// What is assumed of a model until it is measured.
std::uint8_t usual_variant(Trait trait, const Model& model);
/// The trait makes a difference to modules of this model.
bool concerns(Trait trait, const Model& model);

/// What is known of one module. What is not is as usual for its model.
class ModuleTraits {
 public:
  bool empty() const;
  std::optional<std::uint8_t> find(Trait trait) const { return variants_[index(trait)]; }
  /// `variant` is less than how many there are.
  void set(Trait trait, std::uint8_t variant) { variants_[index(trait)] = variant; }
  template <class Variant>
  void set(Trait trait, Variant variant) {
    set(trait, index_of(variant));
  }
  std::uint8_t variant(Trait trait, const Model& model) const {
    return find(trait).value_or(usual_variant(trait, model));
  }
  /// `Variant` is the enumeration of the trait.
  template <class Variant>
  Variant get(Trait trait, const Model& model) const {
    return static_cast<Variant>(variant(trait, model));
  }
  bool operator==(const ModuleTraits&) const = default;

 private:
  static std::size_t index(Trait trait) { return static_cast<std::size_t>(trait); }

  std::array<std::optional<std::uint8_t>, trait_count> variants_{};
};

/// Those of the chip.
void take_traits(ramp::Tmc429& chip, const ModuleTraits& traits);

}  // namespace tmcl
