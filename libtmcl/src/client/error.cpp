#include <algorithm>
#include <array>
#include <cstdint>

#include "tmcl/client_error.hpp"

namespace tmcl::client {
namespace {

namespace json = boost::json;

// JSON-RPC 2.0: the daemon understood the request and did not like it.
constexpr int invalid_params = -32602;
// Of the daemon: what a bus or a module says, and not now.
constexpr int call_failed = -32000;
constexpr int not_allowed = -32003;

struct NamedCode {
  std::string_view name;
  int code;
};
// Of those failures that have a code of their own.
constexpr auto codes_of_failures = std::to_array<NamedCode>({{"parse_error", -32700},
                                                             {"line_too_long", -32700},
                                                             {"invalid_request", -32600},
                                                             {"method_not_found", -32601},
                                                             {"internal_error", -32603},
                                                             {"answer_too_long", -32001},
                                                             {"too_many_clients", -32001},
                                                             {"too_many_requests", -32001},
                                                             {"too_many_subscriptions", -32001},
                                                             {"daemon_ending", -32002}});

// Errors of what could be done, but not as the axis is configured, or not now.
constexpr auto could_be_done = std::to_array<std::string_view>(
    {"beyond_soft_limit", "no_path", "moving", "no_limits", "unknown_units"});
// The members of `data` that Error has itself.
constexpr auto own_members = std::to_array<std::string_view>({"name", "hint", "outcome"});

std::string text_member(const json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string{};
}

Outcome outcome_named(std::string_view name) {
  // The daemon leaves the outcome out where no module is concerned.
  if (name.empty()) return Outcome::not_sent;
  for (const auto outcome : {Outcome::done, Outcome::refused, Outcome::not_sent}) {
    if (name == name_of(outcome)) return outcome;
  }
  return Outcome::unknown;
}

ErrorKind kind_of(std::int64_t code, std::string_view name) {
  if (name == name_of(Errc::move_interrupted) || name == error_name::driver_fault ||
      name == error_name::not_in_position)
    return ErrorKind::ended_early;
  if (code == invalid_params) return kind_of_objection(name);
  return code == not_allowed ? ErrorKind::not_now : ErrorKind::failed;
}

/// By what it asks of the caller, and what it is about.
int code_of(const Error& error) {
  const auto& subject = error.subject;
  const bool is_of_params = error.kind == ErrorKind::bad_request || subject.contains("param") ||
                            error.name == name_of(Errc::beyond_soft_limit);
  if (is_of_params) return invalid_params;
  if (error.kind == ErrorKind::not_now) return not_allowed;
  // What had begun has failed, whatever ended it.
  if (subject.contains("run")) return call_failed;
  const auto* own = std::ranges::find(codes_of_failures, error.name, &NamedCode::name);
  return own == codes_of_failures.end() ? call_failed : own->code;
}

ErrorKind kind_of(Errc code) {
  switch (code) {
    case Errc::bad_argument:
    case Errc::bad_quantity:
    case Errc::decimal_comma:
    case Errc::not_finite:
    case Errc::two_units:
    case Errc::bare_number:
    case Errc::unknown_unit:
    case Errc::wrong_unit:
    case Errc::out_of_range: return ErrorKind::bad_request;
    case Errc::move_interrupted: return ErrorKind::ended_early;
    case Errc::beyond_soft_limit:
    case Errc::axis_claimed:
    case Errc::leased:
    case Errc::lease_lost:
    case Errc::latched:
    case Errc::not_permitted:
    case Errc::stale_request: return ErrorKind::not_now;
    default: return ErrorKind::failed;
  }
}

}  // namespace

ErrorKind kind_of_objection(std::string_view name) {
  const bool could_be = std::ranges::count(could_be_done, name) != 0;
  return could_be ? ErrorKind::not_now : ErrorKind::bad_request;
}

Error error_from_json(const json::object& said) {
  static const json::object nothing;
  const auto* code = said.if_contains("code");
  const auto* data = said.if_contains("data");
  const auto& members = data != nullptr && data->is_object() ? data->get_object() : nothing;
  Error error;
  error.name = text_member(members, "name");
  error.kind = kind_of(code != nullptr && code->is_int64() ? code->get_int64() : 0, error.name);
  error.outcome = outcome_named(text_member(members, "outcome"));
  error.message = text_member(said, "message");
  error.hint = text_member(members, "hint");
  if (error.name.empty()) error.name = "daemon_error";
  for (const auto& [key, value] : members) {
    if (std::ranges::count(own_members, std::string_view(key)) == 0) error.subject[key] = value;
  }
  return without_nulls(std::move(error));
}

json::object to_json(const Error& error) {
  json::object data{{"name", error.name}, {"outcome", name_of(error.outcome)}, {"hint", nullptr}};
  if (!error.hint.empty()) data["hint"] = error.hint;
  data.insert(error.subject.begin(), error.subject.end());
  return {{"code", code_of(error)}, {"message", error.message}, {"data", std::move(data)}};
}

Error without_nulls(Error error) {
  json::object known;
  for (auto& [key, value] : error.subject) {
    if (!value.is_null()) known.emplace(key, std::move(value));
  }
  error.subject = std::move(known);
  return error;
}

Error error_from(const tmcl::Error& said) {
  Error error{std::string(name_of(said.code)), kind_of(said.code), said.outcome, said.message,
              said.hint};
  auto& subject = error.subject;
  if (!said.bus.empty()) subject["bus"] = said.bus;
  if (!said.axis.empty()) subject["axis"] = said.axis;
  if (said.request) {
    subject["address"] = number(said.request->address);
    subject["command"] = describe(*said.request);
  }
  if (said.status) {
    subject["status"] = static_cast<int>(*said.status);
    subject["status_name"] = name_of(*said.status);
  }
  return error;
}

}  // namespace tmcl::client
