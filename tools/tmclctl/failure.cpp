#include "failure.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "method_words.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

ExitCode exit_for(tmcl::Outcome outcome) {
  switch (outcome) {
    case tmcl::Outcome::done: return ExitCode::done;
    case tmcl::Outcome::refused: return ExitCode::refused;
    case tmcl::Outcome::not_sent: return ExitCode::not_sent;
    case tmcl::Outcome::unknown: return ExitCode::unknown;
  }
  return ExitCode::unknown;
}

/// What failed although something was done.
ExitCode exit_for_failure(std::string_view name, tmcl::Outcome outcome) {
  if (outcome != tmcl::Outcome::done) return exit_for(outcome);
  if (name == tmcl::name_of(tmcl::Errc::unexpected_value)) return ExitCode::refused;
  if (name == tmcl::name_of(tmcl::Errc::deadline_passed)) return ExitCode::not_reached;
  return ExitCode::unknown;
}

ExitCode exit_for(const tmcl::Error& error) {
  if (error.code == tmcl::Errc::bad_argument) return ExitCode::usage;
  if (error.code == tmcl::Errc::move_interrupted) return ExitCode::not_reached;
  return exit_for_failure(name_of(error.code), error.outcome);
}

// Errors of what could be done, but not as the axis is configured, or not now.
constexpr auto could_be_done = std::to_array<std::string_view>(
    {"beyond_soft_limit", "no_path", "moving", "no_limits", "unknown_units"});

// JSON-RPC 2.0: the daemon understood the request and did not like it.
constexpr int invalid_params = -32602;
// Of the daemon: not now.
constexpr int not_allowed = -32003;

ExitCode exit_for(const tmcl::client::CallError& error) {
  if (error.name == tmcl::client::error_name::cancelled) return ExitCode::interrupted;
  if (error.name == tmcl::name_of(tmcl::Errc::move_interrupted)) return ExitCode::not_reached;
  if (error.name == driver_fault) return ExitCode::not_reached;
  if (error.code == invalid_params) return exit_for_objection(error.name);
  if (error.code == not_allowed) return ExitCode::refused;
  return exit_for_failure(error.name, error.outcome);
}

std::string text_of(const json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string{};
}

std::string as_sentence(std::string text) {
  if (text.front() >= 'a' && text.front() <= 'z')
    text.front() = static_cast<char>(text.front() - 'a' + 'A');
  return text;
}

bool is_top_level(std::string_view key) {
  return key == "name" || key == "message" || key == "hint" || key == "outcome";
}

}  // namespace

ExitCode exit_for_objection(std::string_view name) {
  const bool could_be = std::ranges::count(could_be_done, name) != 0;
  return could_be ? ExitCode::refused : ExitCode::usage;
}

Failure usage_failure(std::string name, std::string message, std::string hint) {
  return {ExitCode::usage, std::move(name), std::move(message), std::move(hint),
          tmcl::Outcome::not_sent};
}

Failure failure_from(const tmcl::QuantityError& error) {
  return usage_failure(std::string(error.code), error.message, error.hint);
}

Failure failure_from(const tmcl::Error& error) {
  Failure failure{exit_for(error), std::string(name_of(error.code)), error.message, error.hint,
                  error.outcome};
  if (!error.bus.empty()) failure.details["bus"] = error.bus;
  if (error.request) {
    failure.details["address"] = tmcl::number(error.request->address);
    failure.details["command"] = tmcl::describe(*error.request);
  }
  if (error.status) {
    failure.details["status"] = static_cast<int>(*error.status);
    failure.details["status_name"] = name_of(*error.status);
  }
  return failure;
}

Failure failure_from(const tmcl::client::CallError& error) {
  Failure failure{exit_for(error), error.name, with_verbs(error.message), with_verbs(error.hint),
                  error.outcome};
  for (const auto& [key, value] : error.data) {
    if (!is_top_level(key) && !value.is_null()) failure.details[key] = value;
  }
  return failure;
}

std::string describe(const Failure& failure) {
  auto text = failure.message;
  const auto bus = text_of(failure.details, "bus");
  const auto command = text_of(failure.details, "command");
  if (!bus.empty() && text.find(bus) == std::string::npos) text = bus + ": " + text;
  if (!command.empty() && text.find(command) == std::string::npos) text += " (" + command + ")";
  if (!failure.hint.empty()) text += "\n  " + as_sentence(failure.hint);
  return text;
}

boost::json::object to_json(const Failure& failure) {
  json::object object{{"name", failure.name}, {"message", failure.message}};
  if (failure.outcome) object["outcome"] = name_of(*failure.outcome);
  object["hint"] = failure.hint;
  object["exit_code"] = static_cast<int>(failure.exit);
  for (const auto& [key, value] : failure.details) object[key] = value;
  return object;
}

}  // namespace tmclctl
