/// What the axes of a planned path are expected to make of it: told before anything moves.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "api/task.hpp"
#include "gateway/axis/axis.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/plan/path_preparation.hpp"
#include "tmcl/plan/rehearsal.hpp"

namespace tmcld {

/// What a rehearsal needs.
struct Cast {
  std::vector<tmcl::plan::RehearsedAxis> axes;  ///< None where one has no twin.
  std::vector<std::string> names{};
  tmcl::Duration command{};  ///< The longest of any axis.
};
/// The twins of the axes as they are set.
Task<Cast> cast_of(const std::vector<std::shared_ptr<GatewayAxis>>& axes,
                   const std::vector<tmcl::plan::PathAxis>& known);
/// In each mode, that of the request first; empty without twins. It may take a second.
std::vector<api::path::Expected> expected_of(const tmcl::plan::Course& course, const Cast& cast,
                                             const tmcl::plan::PathRequest& request);
/// A sentence about the mode that was asked for; empty if that keeps the tolerance.
std::string warning_of(const std::vector<api::path::Expected>& expected, double tolerance);

}  // namespace tmcld
