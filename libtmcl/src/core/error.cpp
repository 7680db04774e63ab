#include "tmcl/error.hpp"

#include <fmt/format.h>

namespace tmcl {

std::string_view name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::done: return "done";
    case Outcome::refused: return "refused";
    case Outcome::not_sent: return "not_sent";
    case Outcome::unknown: return "unknown";
  }
  return "";
}

std::string_view name_of(Errc code) {
  switch (code) {
    case Errc::refused_by_module: return "refused_by_module";
    case Errc::reply_timeout: return "reply_timeout";
    case Errc::module_silent: return "module_silent";
    case Errc::superseded_by_stop: return "superseded_by_stop";
    case Errc::deadline_passed: return "deadline_passed";
    case Errc::queue_full: return "queue_full";
    case Errc::link_lost: return "link_lost";
    case Errc::link_open_failed: return "link_open_failed";
    case Errc::link_busy: return "link_busy";
    case Errc::bad_argument: return "bad_argument";
    case Errc::move_interrupted: return "move_interrupted";
    case Errc::unexpected_value: return "unexpected_value";
    case Errc::download_broken: return "download_broken";
    case Errc::beyond_soft_limit: return "beyond_soft_limit";
    case Errc::in_bootloader: return "in_bootloader";
    case Errc::axis_claimed: return "axis_claimed";
    case Errc::daemon_ending: return "daemon_ending";
    case Errc::leased: return "leased";
    case Errc::lease_lost: return "lease_lost";
    case Errc::latched: return "latched";
    case Errc::stale_request: return "stale_request";
    case Errc::not_permitted: return "not_permitted";
    case Errc::bad_quantity: return "bad_quantity";
    case Errc::decimal_comma: return "decimal_comma";
    case Errc::not_finite: return "not_finite";
    case Errc::two_units: return "two_units";
    case Errc::bare_number: return "bare_number";
    case Errc::unknown_unit: return "unknown_unit";
    case Errc::wrong_unit: return "wrong_unit";
    case Errc::out_of_range: return "out_of_range";
  }
  return "";
}

std::string describe(const Request& request) {
  const auto subtype = name_of_subtype(request.command, request.type);
  return fmt::format("{} {} {} for motor {} of module {}", name_of(request.command),
                     subtype.empty() ? std::to_string(request.type) : std::string(subtype),
                     request.value, request.motor, number(request.address));
}

std::string describe(const Error& error) {
  std::string text;
  if (!error.bus.empty()) text = error.bus + ": ";
  text += error.message;
  if (error.request) text += " (" + describe(*error.request) + ")";
  if (!error.hint.empty()) text += "\n" + error.hint;
  return text;
}

Error refusal(const Request& request, Status status) {
  const auto* info = find_status(status);
  Error error{Errc::refused_by_module, Outcome::refused, {}, {}, {}, request, status};
  error.message = info != nullptr
                      ? fmt::format("refused: {}", info->meaning)
                      : fmt::format("refused with the unknown status {}", static_cast<int>(status));
  if (info != nullptr) error.hint = info->hint;
  return error;
}

Error not_sent(Errc code, std::string message, std::string hint) {
  return {code, Outcome::not_sent, std::move(message), std::move(hint), {}, {}, {}};
}

Error bad_argument(std::string message, std::string hint) {
  return not_sent(Errc::bad_argument, std::move(message), std::move(hint));
}

}  // namespace tmcl
