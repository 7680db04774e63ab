/// Errors as the command line makes them and shows them.
#pragma once

#include <string>
#include <string_view>

#include <boost/json/object.hpp>

#include "command_line/exit_code.hpp"
#include "tmcl/client_error.hpp"

namespace tmclctl {

using tmcl::client::Error;
using tmcl::client::error_from;
using tmcl::client::ErrorKind;
using tmcl::client::Result;

/// For what is wrong with a request before anything is sent.
Error usage_error(std::string name, std::string message, std::string hint = {});
/// A signal has ended it; `subject` is what is known of it besides.
Error interrupted_error(int signal, std::string message, std::string hint,
                        boost::json::object subject = {});

/// One line for what happened and where, and one for what to try. `gateway`: as for with_gateway.
std::string error_text(const Error& error, std::string_view gateway = {});
/// {"name":..., "message":..., ...}; what stands behind "error" with --json.
boost::json::object error_document(const Error& error, ExitCode exit);
inline boost::json::object error_document(const Error& error) {
  return error_document(error, exit_code_of(error));
}

/// Brings the errors of the library into the one form.
template <class T, class E>
Result<T> attempt(tl::expected<T, E> result) {
  return std::move(result).map_error([](const E& error) { return error_from(error); });
}

}  // namespace tmclctl
