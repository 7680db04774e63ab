#include "tmcl/module_traits.hpp"

#include <algorithm>
#include <utility>

#include "tmcl/spelling.hpp"

namespace tmcl {
namespace {

using Word = std::string_view;

constexpr std::array<Word, 2> origins{"actual", "target"};
constexpr std::array<Word, 2> relative_answers{"distance", "target"};
constexpr std::array<Word, 2> velocity_targets{"turns_on", "goes_there"};
constexpr std::array<Word, 3> limit_stops{"as_set", "hard", "soft"};
constexpr std::array<Word, 2> state_places{"high_byte", "low_byte"};
constexpr std::array<Word, 2> heartbeats{"stops", "ignored"};
constexpr std::array<Word, 2> range_checks{"manual", "wrap"};
constexpr std::array<Word, 2> addressings{"own", "any"};

constexpr std::array<TraitInfo, trait_count> table{{
    {Trait::last_step, "last_step", ramp::Tmc429::last_steps},
    {Trait::factor_rule, "factor_rule", ramp::Tmc429::factor_rules},
    {Trait::order, "order", ramp::Tmc429::orders},
    {Trait::accumulator, "accumulator", ramp::Tmc429::accumulators},
    {Trait::relative_from, "relative_from", origins},
    {Trait::relative_answer, "relative_answer", relative_answers},
    {Trait::velocity_target, "velocity_target", velocity_targets},
    {Trait::limit_stop, "limit_stop", limit_stops},
    {Trait::program_state, "program_state", state_places},
    {Trait::heartbeat, "heartbeat", heartbeats},
    {Trait::range_check, "range_check", range_checks},
    {Trait::addressing, "addressing", addressings},
}};

bool is_newer(Family family) {
  return family == Family::sixpoint || family == Family::tmc4361 || family == Family::firmware;
}

}  // namespace

std::span<const TraitInfo, trait_count> trait_table() { return table; }

// The newer firmware counts relative movements from the target, and tells where they go.
std::uint8_t usual_variant(Trait trait, const Model& model) {
  const bool is_of_relative = trait == Trait::relative_from || trait == Trait::relative_answer;
  return is_of_relative && is_newer(model.family) ? 1 : 0;
}

bool concerns(Trait trait, const Model& model) {
  const bool is_of_chip = trait <= Trait::accumulator || trait == Trait::range_check;
  return !is_of_chip || model.family == Family::tmc429;
}

tl::expected<std::uint8_t, std::string> parse_variant(const TraitInfo& info,
                                                      std::string_view word) {
  const auto found = std::ranges::find(info.variants, word);
  if (found != info.variants.end()) return static_cast<std::uint8_t>(found - info.variants.begin());
  std::string choices;
  for (std::size_t i = 0; i < info.variants.size(); ++i) {
    const bool is_last = i + 1 == info.variants.size();
    choices += std::string(i == 0 ? "" : is_last ? " or " : ", ") + std::string(info.variants[i]);
  }
  return tl::unexpected("is " + quoted(word) + ", but must be " + choices + "." +
                        did_you_mean(word, info.variants));
}

void take_traits(ramp::Tmc429& chip, const ModuleTraits& traits) {
  using R = ramp::Tmc429::Register;
  constexpr std::array<std::pair<Trait, R>, 4> of_chip{{{Trait::last_step, R::last_step},
                                                        {Trait::factor_rule, R::factor_rule},
                                                        {Trait::order, R::order},
                                                        {Trait::accumulator, R::accumulator}}};
  for (const auto& [trait, name] : of_chip) {
    if (const auto variant = traits.find(trait)) chip.write(name, *variant);
  }
}

bool ModuleTraits::empty() const {
  return std::ranges::none_of(variants_, [](const auto& variant) { return variant.has_value(); });
}

}  // namespace tmcl
