// What recorded datagrams mean, for people.
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/trace_file.hpp"
#include "tmcl/version.hpp"

namespace tmcl {
namespace {

constexpr auto about_parameters =
    std::to_array({Command::SAP, Command::GAP, Command::STAP, Command::RSAP});

std::optional<std::span<const std::uint8_t, serial_datagram_size>> serial_bytes(
    const TracedDatagram& datagram) {
  if (datagram.bytes.size() != serial_datagram_size) return std::nullopt;
  return std::span(datagram.bytes).first<serial_datagram_size>();
}

std::optional<Request> request_of(const TracedDatagram& datagram) {
  if (datagram.on_can) return decode_can_request(can_frame_of(datagram));
  const auto bytes = serial_bytes(datagram);
  return bytes ? decode_serial_request(*bytes) : std::nullopt;
}

/// On CAN the text is all of the frame, on a serial line the host's address comes before it.
std::optional<FirmwareVersion> version_of(const TracedDatagram& datagram) {
  const std::string text(datagram.bytes.begin(), datagram.bytes.end());
  return version_from_text(std::string_view(text).substr(datagram.on_can || text.empty() ? 0 : 1));
}

std::string type_text(const Request& request, std::span<const ParameterInfo> parameters) {
  const auto subtype = name_of_subtype(request.command, request.type);
  if (!subtype.empty()) return std::string(subtype);
  if (std::ranges::count(about_parameters, request.command) > 0) {
    if (const auto* row = find_parameter(parameters, request.type)) return std::string(row->name);
  }
  return std::to_string(request.type);
}

std::string text_of(const Request& request, std::span<const ParameterInfo> parameters) {
  return fmt::format("{} {} {} {} motor {}", number(request.address), name_of(request.command),
                     type_text(request, parameters), request.value, request.motor);
}

std::string text_of(const Reply& reply) {
  const auto what = fmt::format("{} {}", reply.module, name_of(reply.command));
  if (reply.status == Status::ok) return fmt::format("{} {}", what, reply.value);
  return fmt::format("{} {} ({}) {}", what, name_of(reply.status),
                     static_cast<unsigned>(reply.status), reply.value);
}

}  // namespace

CanFrame can_frame_of(const TracedDatagram& datagram) {
  CanFrame frame{datagram.can_id, datagram.can_extended};
  const auto size = std::min(datagram.bytes.size(), frame.data.size());
  frame.length = static_cast<std::uint8_t>(size);
  std::copy_n(datagram.bytes.begin(), size, frame.data.begin());
  return frame;
}

std::optional<Reply> reply_of(const TracedDatagram& datagram) {
  if (datagram.on_can) return decode_can_reply(can_frame_of(datagram));
  const auto bytes = serial_bytes(datagram);
  return bytes ? decode_serial_reply(*bytes) : std::nullopt;
}

std::optional<Command> command_of(const TracedDatagram& datagram) {
  if (datagram.is_garbage) return std::nullopt;
  if (datagram.direction == Traffic::Direction::out) {
    const auto request = request_of(datagram);
    return request ? std::optional(request->command) : std::nullopt;
  }
  if (version_of(datagram)) return Command::GET_FIRMWARE_VERSION;
  const auto reply = reply_of(datagram);
  return reply ? std::optional(reply->command) : std::nullopt;
}

std::string describe(const TracedDatagram& datagram, std::span<const ParameterInfo> parameters) {
  if (datagram.is_garbage) return "garbage";
  if (datagram.direction == Traffic::Direction::out) {
    const auto request = request_of(datagram);
    return request ? text_of(*request, parameters) : "no request";
  }
  // A text has no checksum, and may pass for a reply.
  if (const auto version = version_of(datagram))
    return fmt::format("firmware {} of a TMCM-{}", to_string(*version), version->model);
  const auto reply = reply_of(datagram);
  return reply ? text_of(*reply) : "no reply";
}

}  // namespace tmcl
