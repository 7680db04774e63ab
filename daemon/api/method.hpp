/// One row of the method table: what a method is called, takes, gives and does.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include <boost/asio/awaitable.hpp>

#include "api/rpc_error.hpp"
#include "tmcl/command.hpp"

namespace tmcld {

struct Call;

enum class FieldType : std::uint8_t {
  text,
  integer,
  number,
  boolean,
  text_or_integer,
  texts,       ///< An array of texts.
  integers,    ///< An array of integers.
  quantity,    ///< A number, or a text with its unit, such as "12.5mm".
  quantities,  ///< An array of quantities.
  object,
  objects,
  nullable_text,
  nullable_number,
  nullable_boolean,
};

constexpr std::int64_t int32_minimum = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t int32_maximum = std::numeric_limits<std::int32_t>::max();

struct ParamInfo {
  std::string_view name;
  FieldType type;
  bool required;
  std::string_view summary;
  std::int64_t minimum = int32_minimum;  ///< Integers only; nothing outside int32 ever passes.
  std::int64_t maximum = int32_maximum;
};

struct ResultInfo {
  std::string_view name;
  FieldType type;
  std::string_view summary;
};

struct MethodInfo {
  std::string_view name;  ///< noun.verb
  std::string_view summary;
  std::span<const ParamInfo> params;
  std::span<const ResultInfo> result;
  /// What a call can do to a machine at most. Whoever decides which calls are let through looks
  /// here: see admit() in dispatch.cpp.
  tmcl::Effect effect;
  boost::asio::awaitable<RpcResult> (*handler)(Call& call);
};

std::string_view name_of(FieldType type);

/// Every method, grouped by noun.
std::span<const MethodInfo> method_table();
/// Null if there is none of that name.
const MethodInfo* find_method(std::string_view name);

}  // namespace tmcld
