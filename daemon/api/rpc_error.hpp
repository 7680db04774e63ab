/// Errors as clients see them: a JSON-RPC code, a sentence, and data to branch on.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>
#include <tl/expected.hpp>

#include "tmcl/error.hpp"

namespace tmcld {

namespace rpc_code {
constexpr int parse_error = -32700;
constexpr int invalid_request = -32600;
constexpr int method_not_found = -32601;
constexpr int invalid_params = -32602;
constexpr int internal_error = -32603;  ///< An exception.
constexpr int call_failed = -32000;     ///< What a bus or a module says.
constexpr int overload = -32001;        ///< A bound of the daemon was reached.
constexpr int daemon_ending = -32002;
constexpr int not_allowed = -32003;  ///< Not now: another client moves the axis.
}  // namespace rpc_code

/// Of a message and of a hint: an answer with an error for every axis fits a line.
constexpr std::size_t max_error_text_bytes = 1024;

struct RpcError {
  int code = rpc_code::call_failed;
  std::string message;
  /// Always has "name" and "outcome"; names are stable, messages are not.
  boost::json::object data;
};

/// What a method gives back.
using RpcResult = tl::expected<boost::json::object, RpcError>;

/// An error of the daemon itself: nothing was sent.
RpcError rpc_error(int code, std::string_view name, std::string message, std::string hint = {});
/// An error about one parameter of a call.
RpcError param_error(std::string_view name, std::string_view param, std::string message,
                     std::string hint = {});
/// What the library says about a call.
RpcError call_error(const tmcl::Error& error, std::string_view axis = {});

/// {"code":...,"message":...,"data":{...}}
boost::json::object to_json(const RpcError& error);

}  // namespace tmcld
