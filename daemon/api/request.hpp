/// From a line of text to a request, or to the error that answers it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>
#include <tl/expected.hpp>

#include "api/method.hpp"
#include "api/rpc_error.hpp"

namespace tmcld {

constexpr std::size_t max_line_bytes = 64U * 1024U;
constexpr std::size_t max_depth = 16;

struct RpcRequest {
  boost::json::value id;
  const MethodInfo* method = nullptr;
  boost::json::object params;  ///< Checked against the method's row.
};

struct RpcRefusal {
  boost::json::value id;  ///< Null where the line has no usable one.
  RpcError error;
};

tl::expected<RpcRequest, RpcRefusal> parse_request(std::string_view line);
RpcError line_too_long();

/// One line, without its end.
std::string answer_line(const boost::json::value& id, RpcResult result);
std::string notification_line(std::string_view method, boost::json::object params);

}  // namespace tmcld
