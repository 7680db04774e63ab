/// From the names in a call to what they name; a mistyped one is answered with the nearest. An axis
/// has the name that it is configured with, and for every motor see raw_name.hpp.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "api/task.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {

Result<std::shared_ptr<GatewayAxis>> axis_of(const Call& call, const std::string& name);

/// Of what a call runs on a bus, within its deadline.
template <class Params>
RunOptions in_time(const Call& call, const Params& params) {
  RunOptions options;
  options.deadline = call.deadline(params);
  options.permit = call.permit;
  return options;
}

struct ReadyToMove {
  std::shared_ptr<GatewayAxis> axis;
  RunOptions moves;  ///< Ends the movement when a stop comes behind the call.
};

Task<ReadyToMove> ready_to_move(const Call& call, const std::string& axis, Deadline deadline);
/// The axis of a call that may move it: on a module that has said what it is.
template <class Params>
auto ready_to_move(const Call& call, const Params& params) {
  return ready_to_move(call, params.axis, call.deadline(params));
}

using AxisNames = std::optional<std::vector<std::string>>;
/// Each once; all configured ones without names.
Result<std::vector<std::shared_ptr<GatewayAxis>>> axes_of(const Call& call, const AxisNames& names);
Result<std::shared_ptr<GatewayBus>> bus_of(const Call& call, const std::string& name);

struct ParameterChoice {
  std::uint8_t number = 0;
  const tmcl::ParameterInfo* row = nullptr;  ///< Null if no table of the model has this number.

  std::optional<std::string> name() const {
    return row == nullptr ? std::nullopt : std::optional<std::string>(row->name);
  }
};

/// A name, or a number also for a model that is not known.
Result<ParameterChoice> parameter_of(const api::NameOrNumber& given, const GatewayAxis& axis);

/// The numbers of several, each once; `param` is where the client gave them.
Result<std::vector<std::uint8_t>> parameters_of(const std::vector<std::string>& given,
                                                std::string_view param, const GatewayAxis& axis);

/// 0..255 in decimal digits.
std::optional<std::uint8_t> as_number(const std::string& text);

/// An error if a value is outside what the row allows; `param` is where the client gave it.
std::optional<Error> check_range(const tmcl::ParameterInfo* row, std::int64_t value,
                                 std::string_view param);

/// What the client of a call is told that owns the turning of an axis; nothing if it does not.
/// `does`: "may turn" where a chip may have been told so.
std::optional<std::string> warning_of_owner(const Call& call, const GatewayAxis& axis,
                                            std::string_view does = "turns");

}  // namespace tmcld
