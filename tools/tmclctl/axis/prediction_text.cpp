#include "prediction_text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "tmcl/api/axis.hpp"
#include "tmcl/module_traits.hpp"

namespace tmclctl {

namespace api = tmcl::api;
using tmcl::plan::AxisTwin;

namespace {

tmcl::ModuleTraits traits_of(const api::axis::HeldRamp& held) {
  tmcl::ModuleTraits traits;
  for (const auto& told : held.traits) {
    const auto info = std::ranges::find(tmcl::trait_table(), told.trait, &tmcl::TraitInfo::name);
    if (info == tmcl::trait_table().end()) continue;
    // What only a newer gateway knows is as usual here.
    if (const auto variant = tmcl::parse_variant(*info, told.variant))
      traits.set(info->trait, *variant);
  }
  return traits;
}

}  // namespace

Result<AxisTwin> twin_of(const std::string& axis, Context& context) {
  const auto held = context.call(api::axis::GetRamp{axis});
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
        usage_error("not_foreseeable", fmt::format("how {} will move cannot be foreseen: this "
                                                   "tmclctl does not know the ramps of a {}",
                                                   axis, held->model)));
  }
  twin->take_traits(traits_of(*held));
  twin->place({held->position_microsteps});
  return *twin;
}

}  // namespace tmclctl
