/// The parameters of a call, checked against the method's row before the method sees them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json/object.hpp>

#include "api/method.hpp"

namespace tmcld {

/// Nothing if every parameter is one that the method has, of the right type and within range, and
/// none is missing. Otherwise names the first that is not.
std::optional<RpcError> check_params(const MethodInfo& method, const boost::json::object& params);

/// Typed reading of what check_params() has let through.
class Params {
 public:
  explicit Params(boost::json::object object) : object_(std::move(object)) {}

  const boost::json::object& object() const { return object_; }
  bool has(std::string_view name) const { return object_.contains(name); }
  /// The parameter must be there.
  std::string text(std::string_view name) const;
  std::string text_or(std::string_view name, std::string_view otherwise) const {
    return has(name) ? text(name) : std::string(otherwise);
  }
  std::int32_t integer(std::string_view name) const;
  std::int32_t integer_or(std::string_view name, std::int32_t otherwise) const {
    return has(name) ? integer(name) : otherwise;
  }
  double number(std::string_view name) const { return object_.at(name).to_number<double>(); }
  bool boolean_or(std::string_view name, bool otherwise) const {
    return has(name) ? object_.at(name).get_bool() : otherwise;
  }
  /// Empty if the parameter is absent.
  std::vector<std::string> texts(std::string_view name) const;
  /// How many elements an array has; 0 if the parameter is absent.
  std::size_t count(std::string_view name) const {
    return has(name) ? object_.at(name).get_array().size() : 0;
  }
  /// As it came; it must be there.
  const boost::json::value& value(std::string_view name) const { return object_.at(name); }

 private:
  boost::json::object object_;
};

}  // namespace tmcld
