/// What a module has to be asked so that its moves can be foreseen.
#pragma once

#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/model.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/script.hpp"

namespace tmcl::verbs {

/// The settings of the axis' ramp: plan::AxisTwin::parameters(), in this order.
Script<Result<std::vector<plan::Setting>>> read_ramp(AxisAddress axis, const Model& model);

/// The twin of an axis with these settings, there and as fast as the axis is now. Reads speed and
/// position, some milliseconds apart, so the twin of an axis in motion is only about right.
/// `proof`: of its position. Errors: Errc::bad_argument for a model whose ramp generator is not
/// described.
Script<Result<plan::AxisTwin>> read_twin(AxisAddress axis, const Model& model,
                                         std::vector<plan::Setting> ramp,
                                         Proof proof = Proof::none);

}  // namespace tmcl::verbs
