#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "gateway/stop_all.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

json::object to_result(const std::vector<StopReport>& reports) {
  json::array stopped;
  json::array failed;
  for (const auto& report : reports) {
    json::object entry;
    entry["axis"] = report.axis;
    if (report.result) {
      entry["milliseconds"] = std::chrono::duration<double, std::milli>(report.took).count();
      stopped.push_back(std::move(entry));
    } else {
      entry["error"] = to_json(call_error(report.result.error(), report.axis));
      failed.push_back(std::move(entry));
    }
  }
  json::object result;
  result["stopped"] = std::move(stopped);
  result["failed"] = std::move(failed);
  return result;
}

json::object to_json(const ParamInfo& row) {
  json::object out;
  out["name"] = row.name;
  out["type"] = name_of(row.type);
  out["required"] = row.required;
  if (row.type == FieldType::integer || row.type == FieldType::text_or_integer) {
    out["minimum"] = row.minimum;
    out["maximum"] = row.maximum;
  }
  out["summary"] = row.summary;
  return out;
}

json::object to_json(const MethodInfo& method) {
  json::array params;
  for (const auto& row : method.params) params.push_back(to_json(row));
  json::array fields;
  for (const auto& row : method.result) {
    json::object field;
    field["name"] = row.name;
    field["type"] = name_of(row.type);
    field["summary"] = row.summary;
    fields.push_back(std::move(field));
  }
  json::object out;
  out["name"] = method.name;
  out["summary"] = method.summary;
  out["params"] = std::move(params);
  out["result"] = std::move(fields);
  return out;
}

}  // namespace

Answer stop_all(Call& call) {
  const auto reports = co_await tmcld::stop_all(call.gateway);
  co_return to_result(reports);
}

Answer discover(Call&) {
  json::array methods;
  for (const auto& method : method_table()) methods.push_back(to_json(method));
  json::object result;
  result["methods"] = std::move(methods);
  co_return result;
}

}  // namespace tmcld::handlers
