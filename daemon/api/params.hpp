/// The parameters of a call, checked against the method's row before the method sees them.
#pragma once

#include <optional>

#include <boost/json/object.hpp>

#include "api/method.hpp"

namespace tmcld {

/// Nothing if every parameter is one that the method has, of the right type and within range, and
/// none is missing. Otherwise names the first that is not.
std::optional<Error> check_params(const MethodInfo& method, const boost::json::object& params);

}  // namespace tmcld
