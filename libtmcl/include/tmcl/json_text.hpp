/// JSON as text for people too: 10240 and 0.5 where the library would write 1.024E4 and 5E-1. All
/// that is written as JSON goes through here.
#pragma once

#include <string>

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

namespace tmcl {

/// On one line, members in the order they were added. Bytes that are not UTF-8 become U+FFFD.
void append_json(std::string& text, const boost::json::object& object);
void append_json(std::string& text, const boost::json::value& value);
std::string json_text(const boost::json::value& value);
std::string json_text(const boost::json::object& object);

}  // namespace tmcl
