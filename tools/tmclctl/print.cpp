#include "print.hpp"

#include <algorithm>
#include <utility>

#include <boost/json/serialize.hpp>

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr std::size_t column_gap = 2;

json::value text_or_null(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(text);
}

}  // namespace

void print_json(const json::object& document, Output& output) {
  output.out << json::serialize(document) << std::endl;
}

void warn(std::string_view text, Output& output) {
  output.err << "tmclctl: warning: " << text << '\n';
}

void warn(const Warnings& warnings, Output& output) {
  for (const auto& warning : warnings) warn(warning, output);
}

Table::Table(std::vector<std::string> headings) { rows_.push_back(std::move(headings)); }

void Table::add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

void Table::print(std::ostream& out) const {
  std::vector<std::size_t> widths(rows_.front().size());
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i] + std::string(widths[i] - row[i].size() + column_gap, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  }
}

std::string position_text(const AxisReading& reading, bool internal) {
  const bool in_unit = reading.user && !internal;
  return shown(in_unit ? std::optional(reading.user->position_in_unit()) : std::nullopt,
               reading.position.value);
}

std::string target_text(const AxisReading& reading, bool internal) {
  const bool in_unit = reading.user && !internal;
  return shown(in_unit ? std::optional(reading.user->target_in_unit()) : std::nullopt,
               reading.target.value);
}

std::string velocity_text(const AxisReading& reading, bool internal) {
  const bool in_unit = reading.user && !internal;
  return shown(in_unit ? reading.user->velocity_in_unit() : std::nullopt, reading.velocity.value);
}

std::string_view access_text(bool writable, bool stored) {
  if (!writable) return "R";
  return stored ? "RWE" : "RW";
}

json::object to_json(const ModuleRow& row) {
  json::object object{{"bus", row.bus},
                      {"address", row.address},
                      {"model", text_or_null(row.model)},
                      {"model_number", row.model_number},
                      {"firmware", row.firmware},
                      {"axes", row.axes},
                      {"in_bootloader", row.in_bootloader},
                      {"duplicate_suspected", row.duplicate_suspected}};
  if (row.state.empty()) {
    object["address_is_reply_id"] = row.address_is_reply_id;
  } else {
    object["state"] = row.state;
    object["watched_by"] = row.watched_by;
    object["deadman"] = row.deadman;
  }
  return object;
}

json::object to_json(const AxisRow& row) {
  return {{"name", row.name},
          {"bus", row.bus},
          {"address", row.address},
          {"motor", row.motor},
          {"model", text_or_null(row.model)},
          {"state", row.state},
          {"why", text_or_null(row.why)},
          {"unit", text_or_null(row.unit)}};
}

json::object to_json(const std::string& axis, const ParameterValue& value) {
  json::object object{
      {"axis", axis}, {"parameter", value.name}, {"number", value.number}, {"value", value.value}};
  if (value.in_unit) {
    object["value_in_unit"] = value.in_unit->value;
    object["unit"] = value.in_unit->unit;
  }
  return object;
}

json::object to_json(const std::string& axis, const AxisReading& reading) {
  const std::chrono::duration<double, std::milli> age = reading.age;
  json::object object{{"axis", axis},
                      {"position_microsteps", reading.position.value},
                      {"velocity_internal", reading.velocity.value},
                      {"velocity_pps", reading.velocity_pps ? json::value(*reading.velocity_pps)
                                                            : json::value(nullptr)},
                      {"target_microsteps", reading.target.value},
                      {"position_reached", reading.position_reached},
                      {"moving", reading.moving},
                      {"unit", nullptr},
                      {"position", nullptr},
                      {"velocity", nullptr},
                      {"target", nullptr},
                      {"age_ms", age.count()}};
  if (const auto& user = reading.user) {
    object["unit"] = user->unit;
    object["position"] = user->position;
    if (user->velocity) object["velocity"] = *user->velocity;
    object["target"] = user->target;
  }
  const auto& condition = reading.condition;
  object["latched"] = condition.latched;
  object["referenced"] = condition.referenced;
  object["stop_cause"] =
      condition.stop_cause ? json::value(*condition.stop_cause) : json::value(nullptr);
  object["lease"] = condition.lease ? json::value(*condition.lease) : json::value(nullptr);
  object["unattended"] = condition.unattended;
  return object;
}

}  // namespace tmclctl
