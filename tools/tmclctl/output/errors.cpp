#include "errors.hpp"

#include <csignal>
#include <utility>

#include "command_line/method_words.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

// Of an error that a signal has made.
constexpr std::string_view signal_key = "signal";

ExitCode exit_code_of_failure(const Error& error) {
  switch (error.outcome) {
    case tmcl::Outcome::refused: return ExitCode::refused;
    case tmcl::Outcome::not_sent: return ExitCode::not_sent;
    case tmcl::Outcome::unknown: return ExitCode::unknown;
    case tmcl::Outcome::done: break;
  }
  // Something was done, and it failed all the same.
  if (error.name == tmcl::name_of(tmcl::Errc::unexpected_value)) return ExitCode::refused;
  if (error.name == tmcl::name_of(tmcl::Errc::deadline_passed)) return ExitCode::not_reached;
  return ExitCode::unknown;
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

}  // namespace

ExitCode exit_code_of(const Error& error) {
  switch (error.kind) {
    case ErrorKind::bad_request: return ExitCode::usage;
    case ErrorKind::not_now: return ExitCode::refused;
    case ErrorKind::ended_early: return ExitCode::not_reached;
    case ErrorKind::failed: return exit_code_of_failure(error);
    case ErrorKind::interrupted: break;
  }
  const auto* signal = error.subject.if_contains(signal_key);
  const bool is_term = signal != nullptr && *signal == SIGTERM;
  return is_term ? ExitCode::terminated : ExitCode::interrupted;
}

Error usage_error(std::string name, std::string message, std::string hint) {
  return {std::move(name), ErrorKind::bad_request, tmcl::Outcome::not_sent, std::move(message),
          std::move(hint)};
}

Error interrupted_error(int signal, std::string message, std::string hint, json::object subject) {
  subject[signal_key] = signal;
  return {"interrupted",      ErrorKind::interrupted, tmcl::Outcome::done,
          std::move(message), std::move(hint),        std::move(subject)};
}

std::string error_text(const Error& error, std::string_view gateway) {
  auto text = with_verbs(error.message);
  const auto bus = text_of(error.subject, "bus");
  const auto command = text_of(error.subject, "command");
  if (!bus.empty() && text.find(bus) == std::string::npos) text = bus + ": " + text;
  if (!command.empty() && text.find(command) == std::string::npos) text += " (" + command + ")";
  if (!error.hint.empty()) text += "\n  " + as_sentence(with_verbs(error.hint));
  return with_gateway(text, gateway);
}

json::object error_document(const Error& error, ExitCode exit) {
  json::object document{{"name", error.name},
                        {"message", with_verbs(error.message)},
                        {"outcome", name_of(error.outcome)},
                        {"hint", with_verbs(error.hint)},
                        {"exit_code", static_cast<int>(exit)}};
  for (const auto& [key, value] : error.subject) document[key] = value;
  return document;
}

}  // namespace tmclctl
