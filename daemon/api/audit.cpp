#include "api/audit.hpp"

#include "tmcl/json_text.hpp"

namespace tmcld {
namespace {

// Of what a call was given: texts of programs and paths are long.
constexpr std::size_t max_params_bytes = 160;

/// Leases come and go all the time; who takes one away from somebody is to be known.
bool is_audited(const Call& call) {
  const bool is_daily =
      call.method.name.starts_with("lease.") && call.method.role < Role::configure;
  return call.effect != tmcl::Effect::reads && !is_daily;
}

AuditEntry entry_of(const Call& call, std::string text) {
  const auto& who = call.caller.credentials;
  // No process of this computer: the token, or the port, says more.
  const auto name = call.peer->client().name;
  if (who.pid == 0 && !name.empty()) text = "client=\"" + name + "\" " + text;
  return {who.uid, who.pid, std::move(text)};
}

std::string outcome_of(const RpcResult& result) {
  if (result) return " outcome=done";
  const auto& data = result.error().data;
  const auto text = [&](const char* name) {
    return std::string(data.at(name).get_string().c_str());
  };
  return " outcome=" + text("outcome") + " error=" + text("name");
}

}  // namespace

std::string words_of(std::string_view method, const boost::json::object& given) {
  auto params = tmcl::json_text(given);
  if (params.size() > max_params_bytes) params = params.substr(0, max_params_bytes) + "...";
  return "method=" + std::string(method) + " params=" + std::move(params);
}

void begin_journey(Call& call) {
  call.permit.needs_lease = false;
  call.gateway->audit(entry_of(call, words_of(call.method.name, call.params) + " begins"));
}

void audit_end(const Call& call, const RpcResult& result) {
  const bool is_under_way = call.goes_on && result;
  if (!is_audited(call) || is_under_way) return;
  const auto unattended = call.unattended ? " unattended" : "";
  call.gateway->audit(
      entry_of(call, words_of(call.method.name, call.params) + outcome_of(result) + unattended));
}

std::function<void(std::string_view fault)> audit_of_end(const Call& call) {
  return [gateway = std::weak_ptr(call.gateway),
          entry = entry_of(call, words_of(call.method.name, call.params))](std::string_view fault) {
    auto ended = entry;
    ended.text += fault.empty() ? " outcome=done" : " outcome=done error=";
    ended.text += fault;
    if (const auto self = gateway.lock()) self->audit(std::move(ended));
  };
}

}  // namespace tmcld
