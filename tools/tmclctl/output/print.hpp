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
  using Cells = std::vector<std::string>;

  explicit Table(Cells headings);
  /// `wrong`: in red where there are colours.
  void add(Cells cells, bool wrong = false);
  /// Whole, in plain text.
  void print(std::ostream& out) const;
  /// As the command line wants it. On a terminal the widest column is cut to the width of that.
  void print(Output& output) const;

 private:
  std::vector<Cells> rows_;  ///< The headings first.
  std::vector<bool> wrong_;
};

/// A table whose rows are shown as they come. Columns are as wide as their headings, or as they are
/// said to be.
class GrowingTable {
 public:
  GrowingTable(Table::Cells headings, std::vector<std::size_t> widths)
      : headings_(std::move(headings)), widths_(std::move(widths)) {}
  void add(const Table::Cells& row, std::ostream& out);
  std::size_t rows() const { return rows_; }

 private:
  Table::Cells headings_;
  std::vector<std::size_t> widths_;
  std::size_t rows_ = 0;
};

/// In red where the screen has colours.
std::string alarming(std::string_view text, const Screen& screen);

/// In the unit of the axis if it has one, or else, and where `internal`, as the module counts it.
std::string position_text(const AxisReading& reading, bool internal);
std::string target_text(const AxisReading& reading, bool internal);
std::string velocity_text(const AxisReading& reading, bool internal);

/// What a person should know of an axis, in a word or two.
std::string remark_on(const AxisReading& reading);

/// "R", "RW" or, for what can be kept in the EEPROM, "RWE".
std::string_view access_text(bool writable, bool stored);

/// Its standard name, or its number if it has none.
std::string name_of(const tmcl::api::parameter::Number& parameter);

boost::json::object to_json(const std::string& axis, const tmcl::api::parameter::Value& value);

}  // namespace tmclctl
