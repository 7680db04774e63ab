#include "tmcl/model.hpp"

#include <algorithm>
#include <array>

#include "core/text.hpp"

namespace tmcl {
namespace {

constexpr auto all = std::to_array<Model>({
    {1110, "TMCM-1110", 1, Family::tmc429},
    {3110, "TMCM-3110", 3, Family::tmc429},
    {6110, "TMCM-6110", 6, Family::tmc429},
    {142, "TMCM-142", 1, Family::tmc457},
    {146, "PD-146", 1, Family::tmc457},
    {6212, "TMCM-6212", 6, Family::sixpoint},
});

}  // namespace

std::span<const Model> models() { return all; }

const Model* find_model(std::uint16_t number) {
  const auto* row = std::ranges::find(all, number, &Model::number);
  return row == all.end() ? nullptr : row;
}

const Model* find_model(std::string_view name) {
  const auto* row = std::ranges::find_if(all, [&](const Model& model) {
    return text::equal_as_name(model.name, name) ||
           model.name.substr(model.name.find('-') + 1) == name;
  });
  return row == all.end() ? nullptr : row;
}

}  // namespace tmcl
