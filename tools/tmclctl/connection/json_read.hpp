/// Reading the daemon's answers: what is missing or of another kind counts as empty, so that a
/// newer daemon does no harm.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

namespace tmclctl {

std::string text_at(const boost::json::object& object, std::string_view key);
std::optional<double> number_at(const boost::json::object& object, std::string_view key);
bool flag_at(const boost::json::object& object, std::string_view key);
const boost::json::array& array_at(const boost::json::object& object, std::string_view key);
std::vector<std::string> texts_at(const boost::json::object& object, std::string_view key);
const boost::json::object& object_at(const boost::json::object& object, std::string_view key);

/// 0 for what is no integer or does not fit.
template <class Integer>
Integer integer_at(const boost::json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  if (value == nullptr) return Integer{};
  const auto fitting = [](auto number) {
    return std::in_range<Integer>(number) ? static_cast<Integer>(number) : Integer{};
  };
  if (const auto* number = value->if_int64()) return fitting(*number);
  if (const auto* number = value->if_uint64()) return fitting(*number);
  return Integer{};
}

}  // namespace tmclctl
