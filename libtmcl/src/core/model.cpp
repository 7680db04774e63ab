#include "tmcl/model.hpp"

#include <algorithm>

#include "core/model_set.hpp"
#include "core/text.hpp"

namespace tmcl {

std::span<const Model> models() { return all_models; }

const Model* find_model(std::uint16_t number) {
  const auto* row = std::ranges::find(all_models, number, &Model::number);
  return row == all_models.end() ? nullptr : row;
}

const Model* find_model(std::string_view name) {
  const auto* row = std::ranges::find_if(all_models, [&](const Model& model) {
    return text::equal_as_name(model.name, name) ||
           model.name.substr(model.name.find('-') + 1) == name;
  });
  return row == all_models.end() ? nullptr : row;
}

}  // namespace tmcl
