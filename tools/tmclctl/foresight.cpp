#include "foresight.hpp"

#include <fmt/format.h>

#include "tmcl/api/axis.hpp"

namespace tmclctl {

namespace api = tmcl::api;
using tmcl::plan::AxisTwin;

Attempt<AxisTwin> twin_of(const std::string& axis, Target& target) {
  const auto held = target.perform(api::axis::GetRamp{axis});
  if (!held) return tl::unexpected(held.error());
  const auto* model = tmcl::find_model(held->model);
  auto twin = model == nullptr ? std::nullopt : AxisTwin::of(*model);
  if (twin) {
    for (const auto& setting : held->settings) {
      if (!twin->set({setting.number, setting.value})) twin.reset();
      if (!twin) break;
    }
  }
  // The gateway knows such a model, and this program does not: they are of different versions.
  if (!twin) {
    return tl::unexpected(
        usage_failure("not_foreseeable", fmt::format("how {} will move cannot be foreseen: this "
                                                     "tmclctl does not know the ramps of a {}",
                                                     axis, held->model)));
  }
  twin->place({held->position_microsteps});
  return *twin;
}

}  // namespace tmclctl
