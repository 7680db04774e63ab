/// JSON as text for people too: 30517.6 where the library would write 3.05176E4.
#pragma once

#include <string>

#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

namespace tmcld {

/// On one line, members in the order they were added. Bytes that are not UTF-8 become U+FFFD.
void append_json(std::string& text, const boost::json::object& object);
void append_json(std::string& text, const boost::json::value& value);

}  // namespace tmcld
