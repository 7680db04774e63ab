#include "api/handlers.hpp"
#include "gateway/stop_all.hpp"

namespace tmcld::handlers {
namespace {

system::StoppedAxes to_result(const std::vector<StopReport>& reports) {
  system::StoppedAxes result;
  for (const auto& [axis, stopped, took] : reports) {
    const std::chrono::duration<double, std::milli> milliseconds = took;
    if (stopped) {
      result.stopped.push_back({axis, milliseconds.count()});
    } else {
      result.failed.push_back({axis, to_json(call_error(stopped.error(), axis))});
    }
  }
  return result;
}

constexpr std::string_view word_for(tmcl::Effect effect) {
  using enum tmcl::Effect;
  switch (effect) {
    case reads: return "reads";
    case writes: return "writes";
    case moves: return "moves";
    case stops: break;
  }
  return "stops";
}

/// `of_params`: they have bounds, and may be absent; results may be null.
std::vector<rpc::FieldInfo> infos(std::span<const Field> rows, bool of_params) {
  std::vector<rpc::FieldInfo> all;
  for (const auto& row : rows) {
    auto& info = all.emplace_back();
    info.name = row.name;
    info.type = api::name_of(row.type);
    info.summary = row.summary;
    // The members of a field's description are described as the field is.
    const bool again = row.name == api::name_of<&rpc::FieldInfo::members>();
    if (row.inner != nullptr && !again) info.members = infos(row.inner().rows, false);
    if (!of_params && !row.required) info.type += " or null";
    if (!of_params) continue;
    info.required = row.required;
    if (row.type != FieldType::integer && row.type != FieldType::text_or_integer) continue;
    info.minimum = row.minimum;
    info.maximum = row.maximum;
  }
  return all;
}

}  // namespace

Answer<system::StopAll> stop_all(Call& call, const system::StopAll&) {
  const auto reports = co_await tmcld::stop_all(call.gateway, call.permit.client);
  co_return to_result(reports);
}

Answer<rpc::Discover> discover(Call&, const rpc::Discover&) {
  rpc::Methods all;
  for (const auto& method : method_table()) {
    all.methods.push_back({.name = std::string(method.name),
                           .summary = std::string(method.summary),
                           .effect = std::string(word_for(method.effect)),
                           .role = std::string(name_of(method.role)),
                           .params = infos(method.params, true),
                           .result = infos(method.result, false)});
  }
  co_return all;
}

}  // namespace tmcld::handlers
