#include "sim/wire/usbip.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>

namespace tmcl::sim {
namespace {

constexpr std::size_t header_size = 48;

// The words of a header, four bytes each, the highest first.
namespace word {
constexpr std::size_t command = 0;
constexpr std::size_t id = 1;
constexpr std::size_t direction = 3;
constexpr std::size_t endpoint = 4;
constexpr std::size_t status = 5;
constexpr std::size_t cancelled = 5;
constexpr std::size_t length = 6;
}  // namespace word
constexpr std::size_t setup_at = 40;

enum MessageKind : std::uint32_t { submit = 1, cancel = 2, submitted = 3, cancelled = 4 };

std::uint32_t read_word(std::span<const std::uint8_t> header, std::size_t index) {
  std::uint32_t value = 0;
  for (const auto byte : header.subspan(4 * index, 4)) value = value << 8 | byte;
  return value;
}

void write_word(std::span<std::uint8_t> header, std::size_t index, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i)
    header[4 * index + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

std::vector<std::uint8_t> answer_header(MessageKind kind, std::uint32_t id, std::int32_t status) {
  std::vector<std::uint8_t> header(header_size);
  write_word(header, word::command, kind);
  write_word(header, word::id, id);
  write_word(header, word::status, static_cast<std::uint32_t>(status));
  return header;
}

}  // namespace

void UsbipDecoder::feed(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<UsbipDecoder::Command> UsbipDecoder::next() {
  if (is_broken_ || bytes_.size() < header_size) return std::nullopt;
  const std::span<const std::uint8_t> header(bytes_.data(), header_size);
  const auto kind = read_word(header, word::command);
  UsbRequest request;
  request.id = read_word(header, word::id);
  request.in = read_word(header, word::direction) != 0;
  request.endpoint = static_cast<std::uint8_t>(read_word(header, word::endpoint));
  request.length = read_word(header, word::length);
  const UsbipCancel cancel{request.id, read_word(header, word::cancelled)};
  const bool is_submit = kind == MessageKind::submit;
  is_broken_ = (!is_submit && kind != MessageKind::cancel) ||
               (is_submit && request.length > longest_transfer);
  if (is_broken_) return std::nullopt;
  std::ranges::copy(header.subspan(setup_at, request.setup.size()), request.setup.begin());
  const auto body = is_submit && !request.in ? request.length : 0;
  if (bytes_.size() < header_size + body) return std::nullopt;
  const auto end = bytes_.begin() + header_size;
  request.data.assign(end, end + body);
  bytes_.erase(bytes_.begin(), end + body);
  if (is_submit) return request;
  return cancel;
}

std::vector<std::uint8_t> encode_usbip(const UsbResult& result) {
  auto bytes = answer_header(MessageKind::submitted, result.id, result.status);
  write_word(bytes, word::length, result.transferred);
  bytes.insert(bytes.end(), result.data.begin(), result.data.end());
  return bytes;
}

std::vector<std::uint8_t> encode_usbip(const UsbipCancel& cancel, bool in_time) {
  return answer_header(MessageKind::cancelled, cancel.id, in_time ? -ECONNRESET : 0);
}

}  // namespace tmcl::sim
