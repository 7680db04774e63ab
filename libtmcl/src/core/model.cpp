#include "tmcl/model.hpp"

#include <algorithm>

#include "core/model_set.hpp"
#include "core/text.hpp"

namespace tmcl {

std::string_view name_of(Family family) {
  switch (family) {
    case Family::tmc429: return "TMC429";
    case Family::tmc457: return "TMC457";
    case Family::sixpoint: return "sixPoint";
    case Family::tmc4361: return "TMC4361";
    case Family::firmware: return "firmware";
  }
  return "";
}

std::span<const Model> models() { return all_models; }

const Model* find_model(std::uint16_t number) {
  const auto* row = std::ranges::lower_bound(all_models, number, {}, &Model::number);
  return row != all_models.end() && row->number == number ? row : nullptr;
}

const Model* find_model(std::string_view name) {
  const auto* row = std::ranges::find_if(all_models, [&](const Model& model) {
    return text::equal_as_name(model.name, name) ||
           model.name.substr(model.name.find('-') + 1) == name;
  });
  return row == all_models.end() ? nullptr : row;
}

}  // namespace tmcl
