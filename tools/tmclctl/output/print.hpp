/// Lines, tables and JSON documents on the screen.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <boost/json/object.hpp>

#include "axis/quantity_text.hpp"
#include "axis/readings.hpp"
#include "screen.hpp"
#include "tmcl/api/parameter.hpp"

namespace tmclctl {

/// One document on one line.
void print_json(const boost::json::object& document, Output& output);
/// On standard error, also where a document is asked for.
void warn(std::string_view text, Output& output);
/// "short_to_ground_a, undervoltage"
std::string joined(const std::vector<std::string>& names);
void warn(const Warnings& warnings, Output& output);

/// Left-aligned columns under a line of headings.
class Table {
 public:
  explicit Table(std::vector<std::string> headings);
  void add(std::vector<std::string> cells);
  void print(std::ostream& out) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// In the unit of the axis if it has one, or else, and where `internal`, as the module counts it.
std::string position_text(const AxisReading& reading, bool internal);
std::string target_text(const AxisReading& reading, bool internal);
std::string velocity_text(const AxisReading& reading, bool internal);

/// "R", "RW" or, for what can be kept in the EEPROM, "RWE".
std::string_view access_text(bool writable, bool stored);

/// Its standard name, or its number if it has none.
std::string name_of(const tmcl::api::parameter::Number& parameter);

boost::json::object to_json(const std::string& axis, const tmcl::api::parameter::Value& value);

}  // namespace tmclctl
