#include "tmcl/prediction.hpp"

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {

Script<Result<std::vector<plan::Setting>>> read_ramp(AxisAddress axis, const Model& model) {
  const auto parameters = plan::AxisTwin::parameters(model);
  const auto values = co_await must(get_all(axis, parameters));
  std::vector<plan::Setting> ramp;
  for (std::size_t i = 0; i < values.size(); ++i) ramp.push_back({parameters[i], values[i]});
  co_return ramp;
}

Script<Result<plan::AxisTwin>> read_twin(AxisAddress axis, const Model& model,
                                         std::vector<plan::Setting> ramp, Proof proof) {
  auto twin = plan::AxisTwin::of(model);
  if (!twin || !twin->set(ramp)) {
    co_return tl::unexpected(
        bad_argument(fmt::format("what the ramps of a {} look like is not known", model.name)));
  }
  const auto speed = co_await must(velocity(axis));
  const Request read{axis.module, Command::GAP, axis_parameter::actual_position, axis.motor, 0};
  const auto here = co_await must(ask(read, with_proof(proof)));
  twin->place(Microsteps{here}, speed);
  co_return std::move(*twin);
}

}  // namespace tmcl::verbs
