#include "fronts/port_rules.hpp"

#include <algorithm>

#include "api/caller.hpp"

namespace tmcld {
namespace {

/// The module itself has refused this very command, perhaps in another form: see
/// move_relatively().
bool is_of_module(const tmcl::Request& request, const tmcl::Error& error) {
  return error.status && error.request && error.request->command == request.command &&
         error.request->motor == request.motor;
}

}  // namespace

tmcl::SerialBytes to_serial(const Told& told) {
  if (!told.text) return encode_serial(told.reply);
  tmcl::SerialBytes bytes{told.reply.host};
  std::ranges::copy(to_text(*told.text), bytes.begin() + 1);
  return bytes;
}

tmcl::CanFrame to_can(const Told& told, std::uint32_t identifier, CanForm form) {
  const bool is_long = form.length != tmcl::can_datagram_size;
  const std::uint8_t length = is_long ? 8 : tmcl::can_datagram_size;
  if (!told.text) return encode_can(told.reply, identifier, form.extended, length);
  tmcl::CanFrame frame{identifier, form.extended, length, {}};
  std::ranges::copy_n(to_text(*told.text).begin(), length, frame.data.begin());
  return frame;
}

Role role_at_port(const tmcl::Request& request) {
  using tmcl::Command;
  const auto intent = intent_of(request);
  // Hosts set parameters before they move anything, and wait for the end by the event.
  if (request.command == Command::SAP || request.command == Command::TARGET_REACHED_EVENT)
    return Role::operate;
  // A host at a port is not told that what a program moves has no owner.
  return is_unpredictable(intent.motion) ? Role::configure : role_for(intent);
}

bool is_silence(const tmcl::Error& error) {
  using tmcl::Errc;
  if (error.outcome == tmcl::Outcome::unknown) return true;
  switch (error.code) {
    case Errc::bad_argument:
    case Errc::beyond_soft_limit:
    case Errc::superseded_by_stop:
    case Errc::axis_claimed:
    case Errc::daemon_ending:
    case Errc::leased:
    case Errc::lease_lost:
    case Errc::latched:
    case Errc::not_permitted:
    case Errc::stale_request: return false;
    default: return true;
  }
}

tmcl::Reply refusal_at_port(const tmcl::Request& request, std::uint8_t host) {
  return {host, reply_byte(request.address), tmcl::Status::command_not_available, request.command,
          request.value};
}

tmcl::Reply wrong_checksum(tmcl::ModuleAddress module, std::uint8_t host) {
  return {host, reply_byte(module), tmcl::Status::wrong_checksum, tmcl::Command{}, 0};
}

std::optional<Told> told_about(const tmcl::Request& request,
                               const tmcl::Result<tmcl::Answer>& answer, std::uint8_t host,
                               const std::optional<tmcl::Reply>& heard) {
  const bool is_answered = reply_kind(request.command) != tmcl::ReplyKind::none;
  if (answer) {
    if (!is_answered) return std::nullopt;
    return Told{answer->reply, answer->version_text};
  }
  const auto& error = answer.error();
  if (is_of_module(request, error)) {
    // In another form it was refused another value: most modules repeat what they are told.
    const bool is_this = heard && error.request == request && heard->status == *error.status &&
                         heard->command == request.command;
    return Told{{host, reply_byte(request.address), *error.status, request.command,
                 is_this ? heard->value : request.value}};
  }
  if (error.code == tmcl::Errc::refused_by_module) return Told{refusal_at_port(request, host)};
  if (is_silence(error)) return std::nullopt;
  return Told{refusal_at_port(request, host)};
}

}  // namespace tmcld
