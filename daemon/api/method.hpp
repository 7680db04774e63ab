/// One row of the method table: what a method is called, takes, gives and does.
#pragma once

#include <span>
#include <string_view>

#include <boost/asio/awaitable.hpp>

#include "api/error.hpp"
#include "config/config.hpp"
#include "tmcl/api/field.hpp"

namespace tmcld {

namespace api = tmcl::api;

struct Call;

struct MethodInfo {
  std::string_view name;  ///< noun.verb
  std::string_view summary;
  std::span<const api::Field> params;
  std::span<const api::Field> result;
  /// What a call can do to a machine at most. Decides which calls are let
  /// through: see admit() in dispatch.cpp.
  tmcl::Effect effect;
  Role role;  ///< Who may call it; of methods that send any command, see role_for().
  boost::asio::awaitable<Result<boost::json::object>> (*handler)(Call& call);
};

/// Every method, grouped by noun.
std::span<const MethodInfo> method_table();
/// Null if there is none of that name.
const MethodInfo* find_method(std::string_view name);

}  // namespace tmcld
