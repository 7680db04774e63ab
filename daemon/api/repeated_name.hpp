/// Names that stand twice in an object of JSON: readers differ in which of the values they take, so
/// what one has checked another may read otherwise.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <boost/json/value.hpp>

namespace tmcld {

/// The first one in a text, of which `parsed` was read; nothing if there is none.
std::optional<std::string> repeated_name(std::string_view text, const boost::json::value& parsed);

}  // namespace tmcld
