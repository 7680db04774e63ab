/// Requests and replies, and their bytes on a serial line and on CAN, in both directions.
///
/// A serial datagram is nine bytes: address, command, type, motor, four of the value (most
/// significant first) and the sum of the eight before it, modulo 256. CAN leaves the address to the
/// frame's identifier and the sum to the controller: seven bytes, or eight of which the last means
/// nothing.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "tmcl/command.hpp"
#include "tmcl/status.hpp"

namespace tmcl {

/// 0..255 on a serial line (global parameter 66), 0..2047 on CAN (global parameter 71).
enum class ModuleAddress : std::uint16_t {};

constexpr std::uint16_t number(ModuleAddress address) {
  return static_cast<std::uint16_t>(address);
}
/// What a module of this address puts into its replies: the eight low bits.
constexpr std::uint8_t reply_byte(ModuleAddress address) {
  return static_cast<std::uint8_t>(number(address) & 0xFFU);
}

constexpr std::size_t serial_datagram_size = 9;
constexpr std::uint8_t can_datagram_size = 7;
constexpr std::uint8_t default_host_address = 2;   ///< Global parameter 76 of a new module.
constexpr std::uint32_t default_can_reply_id = 2;  ///< Global parameter 70 of a new module.
/// Some modules' bootloaders answer here, whatever parameter 70 says (PyTrinamic's tmclfwupload).
constexpr std::uint32_t can_bootloader_reply_id = 0x7FF;

using SerialBytes = std::array<std::uint8_t, serial_datagram_size>;

struct Request {
  ModuleAddress address{1};
  Command command{};
  std::uint8_t type = 0;
  std::uint8_t motor = 0;  ///< Motor or bank.
  std::int32_t value = 0;
  auto operator<=>(const Request&) const = default;
};

struct Reply {
  std::uint8_t host = default_host_address;  ///< Serial only; on CAN it is the frame's identifier.
  std::uint8_t module = 1;
  Status status = Status::ok;
  Command command{};
  std::int32_t value = 0;
  auto operator<=>(const Reply&) const = default;
};

struct CanFrame {
  std::uint32_t id = 0;
  bool extended = false;
  std::uint8_t length = 0;  ///< 0..8
  std::array<std::uint8_t, 8> data{};
  auto operator<=>(const CanFrame&) const = default;
};

/// What a frame takes on the wire, with the pause behind it, and with as many stuffed bits as there
/// can be: one after each four from the start of the frame to its CRC (ISO 11898-1).
constexpr std::size_t most_bits_of_frame(std::size_t length, bool extended = false) {
  const std::size_t stuffed_part = (extended ? 54U : 34U) + 8 * length;
  constexpr std::size_t rest = 13;  // from the CRC's delimiter to the next frame
  return stuffed_part + (stuffed_part - 1) / 4 + rest;
}

constexpr std::uint8_t checksum(std::span<const std::uint8_t> bytes) {
  std::uint8_t sum = 0;
  for (const auto byte : bytes) sum = static_cast<std::uint8_t>(sum + byte);
  return sum;
}

namespace detail {

constexpr void put_value(std::span<std::uint8_t> out, std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  for (std::size_t i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>(bits >> (24U - 8U * i));
}

constexpr std::int32_t get_value(std::span<const std::uint8_t> in) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits = bits << 8U | in[i];
  return static_cast<std::int32_t>(bits);
}

constexpr SerialBytes sealed(SerialBytes bytes) {
  bytes[8] = checksum(std::span(bytes).first(8));
  return bytes;
}

constexpr bool is_sealed(std::span<const std::uint8_t, serial_datagram_size> bytes) {
  return bytes[8] == checksum(bytes.first(8));
}

}  // namespace detail

/// The address must be 0..255: only its eight low bits go out.
constexpr SerialBytes encode_serial(const Request& request) {
  SerialBytes bytes{reply_byte(request.address), static_cast<std::uint8_t>(request.command),
                    request.type, request.motor};
  detail::put_value(std::span(bytes).subspan(4, 4), request.value);
  return detail::sealed(bytes);
}

constexpr SerialBytes encode_serial(const Reply& reply) {
  SerialBytes bytes{reply.host, reply.module, static_cast<std::uint8_t>(reply.status),
                    static_cast<std::uint8_t>(reply.command)};
  detail::put_value(std::span(bytes).subspan(4, 4), reply.value);
  return detail::sealed(bytes);
}

/// Nothing if the checksum is wrong.
constexpr std::optional<Request> decode_serial_request(
    std::span<const std::uint8_t, serial_datagram_size> bytes) {
  if (!detail::is_sealed(bytes)) return std::nullopt;
  return Request{ModuleAddress{bytes[0]}, static_cast<Command>(bytes[1]), bytes[2], bytes[3],
                 detail::get_value(bytes.subspan(4, 4))};
}

/// Nothing if the checksum is wrong.
constexpr std::optional<Reply> decode_serial_reply(
    std::span<const std::uint8_t, serial_datagram_size> bytes) {
  if (!detail::is_sealed(bytes)) return std::nullopt;
  return Reply{bytes[0], bytes[1], static_cast<Status>(bytes[2]), static_cast<Command>(bytes[3]),
               detail::get_value(bytes.subspan(4, 4))};
}

/// The frame's identifier is the module's address.
constexpr CanFrame encode_can(const Request& request, bool extended = false) {
  CanFrame frame{number(request.address),
                 extended,
                 can_datagram_size,
                 {static_cast<std::uint8_t>(request.command), request.type, request.motor}};
  detail::put_value(std::span(frame.data).subspan(3, 4), request.value);
  return frame;
}

/// A module answers in the form it was asked in: same identifier format, seven bytes for seven,
/// otherwise eight.
constexpr CanFrame encode_can(const Reply& reply, std::uint32_t reply_id, bool extended = false,
                              std::uint8_t length = can_datagram_size) {
  CanFrame frame{reply_id,
                 extended,
                 length,
                 {reply.module, static_cast<std::uint8_t>(reply.status),
                  static_cast<std::uint8_t>(reply.command)}};
  detail::put_value(std::span(frame.data).subspan(3, 4), reply.value);
  return frame;
}

/// Nothing if the frame has fewer than seven bytes or an identifier above 2047.
constexpr std::optional<Request> decode_can_request(const CanFrame& frame) {
  if (frame.length < can_datagram_size || frame.id > 0x7FF) return std::nullopt;
  return Request{ModuleAddress{static_cast<std::uint16_t>(frame.id)},
                 static_cast<Command>(frame.data[0]), frame.data[1], frame.data[2],
                 detail::get_value(std::span(frame.data).subspan(3, 4))};
}

/// Nothing if the frame has fewer than seven bytes. The identifier is not looked at, except that
/// its eight low bits become the host address.
constexpr std::optional<Reply> decode_can_reply(const CanFrame& frame) {
  if (frame.length < can_datagram_size) return std::nullopt;
  return Reply{static_cast<std::uint8_t>(frame.id & 0xFFU), frame.data[0],
               static_cast<Status>(frame.data[1]), static_cast<Command>(frame.data[2]),
               detail::get_value(std::span(frame.data).subspan(3, 4))};
}

}  // namespace tmcl
