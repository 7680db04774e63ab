#include "foresight.hpp"

#include <fmt/format.h>

namespace tmclctl {
namespace {

using tmcl::plan::AxisTwin;

Failure not_foreseeable(const std::string& axis, const std::string& why) {
  return usage_failure("not_foreseeable",
                       fmt::format("how {} will move cannot be foreseen: {}", axis, why));
}

}  // namespace

Attempt<AxisTwin> twin_of(const std::string& axis, Target& target) {
  const auto units = target.units(axis);
  if (!units) return tl::unexpected(units.error());
  if (units->model == nullptr)
    return tl::unexpected(not_foreseeable(axis, "the model of its module is not known"));
  auto twin = AxisTwin::of(*units->model);
  if (!twin) {
    return tl::unexpected(not_foreseeable(
        axis, fmt::format("nobody has described the ramps of a {}", units->model->name)));
  }
  for (const auto parameter : AxisTwin::parameters(*units->model)) {
    const auto value = target.get(axis, std::to_string(parameter));
    if (!value) return tl::unexpected(value.error());
    if (!twin->set({parameter, value->value})) {
      return tl::unexpected(not_foreseeable(
          axis,
          fmt::format("{} is {}, which such a module cannot hold", value->name, value->value)));
    }
  }
  const auto state = target.state(axis);
  if (!state) return tl::unexpected(state.error());
  // Where it is when the command comes could only be guessed.
  if (state->moving) return tl::unexpected(not_foreseeable(axis, "it moves already"));
  twin->place(state->position);
  return *twin;
}

}  // namespace tmclctl
