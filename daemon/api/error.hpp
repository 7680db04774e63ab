/// Errors as methods answer with them: the form in which their clients have them, too.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "tmcl/api/field.hpp"
#include "tmcl/client_error.hpp"
#include "tmcl/error.hpp"

namespace tmcld {

using tmcl::client::Error;
using tmcl::client::ErrorKind;
using tmcl::client::Result;

/// Of a message and of a hint: an answer with an error for every axis fits a line.
constexpr std::size_t max_error_text_bytes = 1024;

// Of the daemon itself: nothing was sent.

/// It could be done, but for the state or the configuration.
Error not_now(std::string_view name, std::string message, std::string hint = {});
Error failed(std::string_view name, std::string message, std::string hint = {});
/// It is about one parameter of a call.
Error param_error(std::string_view name, std::string_view param, std::string message,
                  std::string hint = {});
/// The same about a member of their struct.
template <auto member>
Error param_error(std::string_view name, std::string message, std::string hint = {}) {
  return param_error(name, tmcl::api::name_of<member>(), std::move(message), std::move(hint));
}

/// What the library says about a call; what it does not know is null.
Error call_error(const tmcl::Error& error, std::string_view axis = {});

}  // namespace tmcld
