/// Everything that can go wrong, in the one form in which it is shown.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>

#include "exit_code.hpp"
#include "tmcl/client.hpp"
#include "tmcl/error.hpp"
#include "tmcl/quantity.hpp"

namespace tmclctl {

struct Failure {
  ExitCode exit = ExitCode::usage;
  std::string name;     ///< snake_case; the same through the daemon and without it.
  std::string message;  ///< What happened, in one sentence without a full stop.
  std::string hint{};   ///< What to try; may be empty.
  std::optional<tmcl::Outcome> outcome{};
  boost::json::object details{};  ///< What else is known: bus, command, status, axis ...
};

template <class T>
using Attempt = tl::expected<T, Failure>;

/// For what is wrong with a request before anything is sent: usage, unless it could be done but for
/// the state or the configuration of an axis.
ExitCode exit_for_objection(std::string_view name);
/// Of axis.wait: the axis has arrived by its counter, and its driver was off.
constexpr std::string_view driver_fault = "driver_fault";

Failure usage_failure(std::string name, std::string message, std::string hint = {});
Failure failure_from(const tmcl::Error& error);
Failure failure_from(const tmcl::QuantityError& error);
Failure failure_from(const tmcl::client::CallError& error);

/// One line for what happened and where, and one for what to try.
std::string describe(const Failure& failure);
/// {"name":..., "message":..., ...}; what stands behind "error" with --json.
boost::json::object to_json(const Failure& failure);

/// Brings the errors of the library and of the client into the one form.
template <class T, class E>
Attempt<T> attempt(tl::expected<T, E> result) {
  return std::move(result).map_error([](const E& error) { return failure_from(error); });
}

}  // namespace tmclctl
