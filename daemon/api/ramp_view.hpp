/// A ramp as it is told: what makes it, and what it gives.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tmcl/api/axis.hpp"
#include "tmcl/api/ramp.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/plan/ramp_search.hpp"
#include "tmcl/plan/ramp_wish.hpp"

namespace tmcld {

/// By name, from the table of the model, which has a row for everything that is chosen from it.
std::vector<tmcl::api::axis::RampSetting> view_of(const std::vector<tmcl::plan::Setting>& settings,
                                                  std::span<const tmcl::ParameterInfo> parameters);
/// Without the axis and its unit. `unit`: how many of it a microstep is; nothing without one.
tmcl::api::axis::Ramp view_of(const tmcl::plan::PlannedRamp& planned, const tmcl::Model& model,
                              std::optional<double> unit);
/// One of several; `unit` as above.
tmcl::api::ramp::ComparedRamp view_of(const std::vector<tmcl::plan::Setting>& settings,
                                      const tmcl::plan::RampVerdict& verdict,
                                      const tmcl::Model& model, std::optional<double> unit);
/// One that was sought; the axis and its unit are left out, `unit` as above.
tmcl::api::ramp::Found view_of(const tmcl::plan::FoundRamp& found,
                               const tmcl::plan::RampSearch& search,
                               const std::optional<tmcl::plan::MotorWish>& motor,
                               std::optional<double> unit);

}  // namespace tmcld
