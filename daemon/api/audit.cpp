#include "api/audit.hpp"

#include "tmcl/json_text.hpp"

#include "tmcl/api/lease.hpp"

namespace tmcld {
namespace {

// Of one text: longer than any quantity (libtmcl/src/core/quantity.cpp). Texts of programs and
// paths are long.
constexpr std::size_t max_text_bytes = 80;
// Of one list: more than the axes of a call.
constexpr std::size_t max_list_elements = 256;

constexpr auto secret_name = api::name_of<&api::lease::OnLease::epoch>();

/// Leases come and go all the time; the client that takes one away is to be known.
bool is_audited(const Call& call) {
  const bool is_daily =
      call.method.name.starts_with("lease.") && call.method.role < Role::configure;
  return call.effect != tmcl::Effect::reads && !is_daily;
}

AuditEntry entry_of(const Call& call, std::string text) {
  const auto& who = call.caller.credentials;
  // No process of this computer, or one that speaks for others: the name says more.
  const auto name = call.peer->client().name;
  if ((who.pid == 0 || !call.caller.user.empty()) && !name.empty())
    text = "client=\"" + name + "\" " + text;
  if (call.lease) text += " lease=" + std::to_string(*call.lease);
  return {who.uid, who.pid, std::move(text)};
}

/// Never within a letter of UTF-8.
boost::json::value shortened(const boost::json::string& text) {
  if (text.size() <= max_text_bytes) return text;
  const auto is_within_letter = [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
  };
  auto end = max_text_bytes;
  while (end > 0 && is_within_letter(text[end])) --end;
  return boost::json::value(std::string(text.data(), end) + "...");
}

boost::json::value shortened(const boost::json::value& value);

boost::json::value shortened(const boost::json::array& list) {
  boost::json::array result;
  for (const auto& one : list) {
    if (result.size() == max_list_elements) {
      result.emplace_back("... " + std::to_string(list.size()) + " in all");
      break;
    }
    result.push_back(shortened(one));
  }
  return result;
}

boost::json::value shortened(const boost::json::object& object) {
  boost::json::object result;
  for (const auto& [name, value] : object) result.emplace(name, shortened(value));
  return result;
}

boost::json::value shortened(const boost::json::value& value) {
  if (value.is_string()) return shortened(value.get_string());
  if (value.is_array()) return shortened(value.get_array());
  if (value.is_object()) return shortened(value.get_object());
  return value;
}

std::string outcome_of(const Result<boost::json::object>& result) {
  if (result) return " outcome=done";
  const auto& error = result.error();
  return " outcome=" + std::string(name_of(error.outcome)) + " error=" + error.name;
}

}  // namespace

std::string words_of(std::string_view method, const boost::json::object& given) {
  boost::json::object params;
  for (const auto* name : {"axis", "axes"})
    if (const auto* value = given.if_contains(name)) params.emplace(name, shortened(*value));
  for (const auto& [name, value] : given)
    if (name != secret_name) params.emplace(name, shortened(value));
  return "method=" + std::string(method) + " params=" + tmcl::json_text(params);
}

void begin_journey(Call& call) {
  call.permit.needs_lease = false;
  call.gateway->audit(entry_of(call, words_of(call.method.name, call.params) + " begins"));
}

void audit_end(const Call& call, const Result<boost::json::object>& result) {
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
