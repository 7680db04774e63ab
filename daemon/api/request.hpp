/// From a line of text to a request, or to the error that answers it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

#include "api/common_params.hpp"
#include "api/error.hpp"
#include "api/method.hpp"

namespace tmcld {

/// Of a line to the daemon.
constexpr std::size_t max_line_bytes = 64U * 1024U;
/// Of a line from it: all axes that can be configured fit, each with an error.
constexpr std::size_t max_answer_bytes = 1024U * 1024U;
/// Of an id that is a string.
constexpr std::size_t max_id_bytes = 256;
constexpr std::size_t max_depth = 16;

struct RpcRequest {
  boost::json::value id;
  const MethodInfo* method = nullptr;
  boost::json::object params;                ///< Checked against the method's row.
  std::optional<LeaseKey> lease{};           ///< What it is made under, if it names that.
  std::optional<tmcl::TimePoint> sent_at{};  ///< By its sender's clock, which is that of this host.
};

struct ParsedLine {
  boost::json::value id{};  ///< Null where the line has no usable one.
  Result<RpcRequest> request;
};

/// Without an id. Errors: there is no such method, or its parameters are others.
Result<RpcRequest> make_request(std::string_view method, boost::json::object params);
ParsedLine parse_request(std::string_view line);
Error line_too_long();

/// One line, without its end; never longer than max_answer_bytes with it. `effect`: of the method
/// that gave the result.
std::string answer_line(const boost::json::value& id, const Result<boost::json::object>& result,
                        tmcl::Effect effect = tmcl::Effect::reads);
std::string notification_line(std::string_view method, const boost::json::object& params);

}  // namespace tmcld
