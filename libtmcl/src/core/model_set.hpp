/// The table of models, and sets of them: which models a parameter is on.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>

#include "tmcl/model.hpp"

namespace tmcl {

inline constexpr auto all_models = std::to_array<Model>({
    {1110, "TMCM-1110", 1, Family::tmc429},
    {3110, "TMCM-3110", 3, Family::tmc429},
    {6110, "TMCM-6110", 6, Family::tmc429},
    {142, "TMCM-142", 1, Family::tmc457},
    {146, "PD-146", 1, Family::tmc457},
    {6212, "TMCM-6212", 6, Family::sixpoint},
    {1111, "TMCM-1111", 1, Family::tmc4361},
});

/// One bit for each model, in the order of the table.
using ModelSet = std::uint64_t;
static_assert(all_models.size() <= 64);

constexpr ModelSet set_of(std::size_t index) { return ModelSet{1} << index; }

inline constexpr ModelSet every_model = ~ModelSet{0};

consteval ModelSet only(std::initializer_list<std::uint16_t> numbers) {
  ModelSet set = 0;
  for (const auto number : numbers) {
    const auto* row = std::ranges::find(all_models, number, &Model::number);
    if (row == all_models.end()) throw std::logic_error("no such model");
    set |= set_of(static_cast<std::size_t>(row - all_models.begin()));
  }
  return set;
}

consteval ModelSet except(std::initializer_list<std::uint16_t> numbers) { return ~only(numbers); }

constexpr ModelSet models_of(Family family) {
  ModelSet set = 0;
  for (std::size_t i = 0; i < all_models.size(); ++i) {
    if (all_models[i].family == family) set |= set_of(i);
  }
  return set;
}

}  // namespace tmcl
