#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/state_json.hpp"
#include "async/gather.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

struct StopReport {
  tmcl::Result<void> result;
  tmcl::Duration took{};
};

boost::asio::awaitable<StopReport> stop_one(std::shared_ptr<GatewayAxis> axis) {
  const auto began = axis->bus().clock().now();
  StopReport report;
  report.result = co_await axis->stop();
  report.took = axis->bus().clock().now() - began;
  co_return report;
}

/// A raw command may be about to move a motor that no axis is configured for.
boost::asio::awaitable<StopReport> stop_other(std::shared_ptr<GatewayBus> bus,
                                              tmcl::AxisAddress motor) {
  StopReport report;
  RunOptions options;
  report.result = co_await bus->run(tmcl::verbs::stop(motor), std::move(options));
  co_return report;
}

json::object to_result(std::span<const std::shared_ptr<GatewayAxis>> axes,
                       const std::vector<StopReport>& reports) {
  json::array stopped;
  json::array failed;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    json::object entry;
    entry["axis"] = axes[i]->name();
    if (reports[i].result) {
      entry["milliseconds"] = std::chrono::duration<double, std::milli>(reports[i].took).count();
      stopped.push_back(std::move(entry));
    } else {
      entry["error"] = to_json(call_error(reports[i].result.error(), axes[i]->name()));
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
  const auto axes = call.gateway->axes();
  // All of them lose the right to move before the first stop is on its way.
  call.gateway->revoke_movements();
  std::vector<boost::asio::awaitable<StopReport>> stops;
  for (const auto& axis : axes) stops.push_back(stop_one(axis));
  for (const auto& bus : call.gateway->buses()) {
    for (const auto motor : bus->motors().others_about_to_move())
      stops.push_back(stop_other(bus, motor));
  }
  ++call.gateway->stops_in_progress;
  const auto reports = co_await gather(std::move(stops));
  --call.gateway->stops_in_progress;
  co_return to_result(axes, reports);
}

Answer discover(Call&) {
  json::array methods;
  for (const auto& method : method_table()) methods.push_back(to_json(method));
  json::object result;
  result["methods"] = std::move(methods);
  co_return result;
}

}  // namespace tmcld::handlers
