// The blocks are those of draft-ietf-opsawg-pcapng: a type, a length, what the type says, options,
// and the length again, all of whole words of four bytes.
#include "tmcl/trace_file.hpp"

#include <array>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include <fmt/format.h>

namespace tmcl {
namespace {

using std::chrono::microseconds;

constexpr std::uint32_t section_block = 0x0A0D0D0A;
constexpr std::uint32_t interface_block = 1;
constexpr std::uint32_t packet_block = 6;
constexpr std::uint32_t byte_order_magic = 0x1A2B3C4D;
constexpr std::uint16_t link_type = 147;  // USER0
constexpr std::size_t word = 4;

constexpr std::uint16_t option_end = 0;
constexpr std::uint16_t option_comment = 1;
constexpr std::uint16_t option_interface_name = 2;
constexpr std::uint16_t option_packet_flags = 2;
constexpr std::uint16_t option_time_resolution = 9;
constexpr std::uint32_t inbound = 1;
constexpr std::uint32_t outbound = 2;

constexpr std::size_t header_size = 5;
constexpr std::uint8_t flag_in = 1;
constexpr std::uint8_t flag_can = 2;
constexpr std::uint8_t flag_extended = 4;
constexpr std::uint8_t flag_garbage = 8;

static_assert(std::endian::native == std::endian::little,
              "files are written as they are in memory");

template <class T>
void put(std::string& to, T value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void pad(std::string& text) { text.resize((text.size() + word - 1) / word * word); }

void put_option(std::string& to, std::uint16_t code, std::string_view value) {
  put(to, code);
  put(to, static_cast<std::uint16_t>(value.size()));
  to += value;
  pad(to);
}

std::string block(std::uint32_t type, const std::string& body) {
  std::string text;
  const auto length = static_cast<std::uint32_t>(body.size() + 3 * word);
  put(text, type);
  put(text, length);
  text += body;
  put(text, length);
  return text;
}

std::string payload_of(const TracedDatagram& datagram) {
  std::string payload;
  std::uint8_t flags = datagram.direction == Traffic::Direction::in ? flag_in : 0;
  if (datagram.on_can) flags |= flag_can;
  if (datagram.can_extended) flags |= flag_extended;
  if (datagram.is_garbage) flags |= flag_garbage;
  put(payload, flags);
  for (const unsigned shift : {24U, 16U, 8U, 0U})
    put(payload, static_cast<std::uint8_t>(datagram.can_id >> shift));
  for (const auto byte : datagram.bytes) put(payload, byte);
  return payload;
}

}  // namespace

std::string trace_file_header(std::string_view bus) {
  std::string section;
  put(section, byte_order_magic);
  put(section, std::uint16_t{1});
  put(section, std::uint16_t{0});
  put(section, std::int64_t{-1});  // its length is not known
  std::string interface;
  put(interface, link_type);
  put(interface, std::uint16_t{0});
  put(interface, std::uint32_t{0});  // packets of any length
  if (!bus.empty()) {
    put_option(interface, option_interface_name, bus);
    put_option(interface, option_end, {});
  }
  return block(section_block, section) + block(interface_block, interface);
}

std::string trace_file_packet(const TracedDatagram& datagram) {
  const auto time = std::chrono::floor<microseconds>(datagram.at).time_since_epoch().count();
  const auto payload = payload_of(datagram);
  const auto size = static_cast<std::uint32_t>(payload.size());
  std::string body;
  put(body, std::uint32_t{0});
  put(body, static_cast<std::uint32_t>(static_cast<std::uint64_t>(time) >> 32U));
  put(body, static_cast<std::uint32_t>(time));
  put(body, size);
  put(body, size);
  body += payload;
  pad(body);
  std::string flags;
  put(flags, datagram.direction == Traffic::Direction::in ? inbound : outbound);
  put_option(body, option_packet_flags, flags);
  if (!datagram.client.empty()) put_option(body, option_comment, datagram.client);
  put_option(body, option_end, {});
  return block(packet_block, body);
}

// ---- reading ------------------------------------------------------------------------------------

namespace {

/// Takes from the front; what is not there is 0 and remembered.
class Cursor {
 public:
  explicit Cursor(std::string_view rest) : rest_(rest) {}
  template <class T>
  T take() {
    T value{};
    if (const auto bytes = take(sizeof value); bytes.size() == sizeof value)
      std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::string_view take(std::size_t count) {
    is_short_ = is_short_ || count > rest_.size();
    const auto taken = rest_.substr(0, is_short_ ? 0 : count);
    rest_.remove_prefix(taken.size());
    return taken;
  }
  std::string_view take_padded(std::size_t count) {
    const auto taken = take(count);
    take((word - count % word) % word);
    return taken;
  }
  bool is_short() const { return is_short_; }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  bool is_short_ = false;
};

std::optional<std::string_view> find_option(std::string_view options, std::uint16_t wanted) {
  Cursor cursor(options);
  while (!cursor.rest().empty() && !cursor.is_short()) {
    const auto code = cursor.take<std::uint16_t>();
    const auto value = cursor.take_padded(cursor.take<std::uint16_t>());
    if (cursor.is_short() || code == option_end) break;
    if (code == wanted) return value;
  }
  return std::nullopt;
}

struct Interface {
  std::uint16_t link_type = 0;
  double ticks_per_us = 1;
};

TracedDatagram datagram_of(std::string_view payload) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(payload[i]); };
  TracedDatagram datagram;
  const auto flags = byte(0);
  datagram.direction = (flags & flag_in) != 0 ? Traffic::Direction::in : Traffic::Direction::out;
  datagram.on_can = (flags & flag_can) != 0;
  datagram.can_extended = (flags & flag_extended) != 0;
  datagram.is_garbage = (flags & flag_garbage) != 0;
  for (std::size_t i = 1; i < header_size; ++i) datagram.can_id = datagram.can_id << 8U | byte(i);
  for (const auto each : payload.substr(header_size))
    datagram.bytes.push_back(static_cast<std::uint8_t>(each));
  return datagram;
}

class TraceReader {
 public:
  tl::expected<Trace, std::string> read(std::string_view contents) {
    while (at_ < contents.size()) {
      if (auto problem = read_block(contents.substr(at_)))
        return tl::unexpected(fmt::format("byte {}: {}", at_, *problem));
    }
    if (at_ == 0) return tl::unexpected(std::string("the file is empty"));
    return std::move(trace_);
  }

 private:
  std::optional<std::string> read_block(std::string_view rest) {
    Cursor head(rest);
    const auto type = head.take<std::uint32_t>();
    const auto length = head.take<std::uint32_t>();
    if (at_ == 0 && type != section_block) return "this is no pcapng file";
    if (type == section_block && head.take<std::uint32_t>() != byte_order_magic)
      return "a pcapng file of the other byte order";
    if (head.is_short() || length < 3 * word || length % word != 0 || length > rest.size())
      return "the file ends within a block";
    auto problem = read_body(type, rest.substr(2 * word, length - 3 * word));
    at_ += problem ? 0 : length;
    return problem;
  }

  std::optional<std::string> read_body(std::uint32_t type, std::string_view body) {
    if (type == section_block) interfaces_.clear();
    if (type == interface_block) return read_interface(body);
    if (type == packet_block) return read_packet(body);
    return std::nullopt;
  }

  std::optional<std::string> read_interface(std::string_view body) {
    Cursor cursor(body);
    Interface interface { cursor.take<std::uint16_t>() };
    cursor.take(word + 2);
    if (cursor.is_short()) return "an interface without a link type";
    if (const auto name = find_option(cursor.rest(), option_interface_name)) trace_.bus = *name;
    const auto resolution = find_option(cursor.rest(), option_time_resolution);
    if (resolution && !resolution->empty()) {
      constexpr unsigned binary = 0x80;
      constexpr double us_per_s = 1e6;
      const auto exponent = static_cast<std::uint8_t>(resolution->front());
      const double base = (exponent & binary) != 0 ? 2 : 10;
      interface.ticks_per_us = std::pow(base, exponent & (binary - 1)) / us_per_s;
    }
    interfaces_.push_back(interface);
    return std::nullopt;
  }

  std::optional<std::string> read_packet(std::string_view body) {
    Cursor cursor(body);
    const auto number = cursor.take<std::uint32_t>();
    const std::uint64_t high = cursor.take<std::uint32_t>();
    const auto ticks = high << 32U | cursor.take<std::uint32_t>();
    const auto size = cursor.take<std::uint32_t>();
    cursor.take(word);
    const auto payload = cursor.take_padded(size);
    if (cursor.is_short()) return "a packet that is longer than its block";
    if (number >= interfaces_.size()) return fmt::format("a packet of interface {}", number);
    const auto& interface = interfaces_[number];
    if (interface.link_type != link_type || size < header_size) return std::nullopt;
    constexpr double latest_us = 9e15;  // what fits in nanoseconds
    const double us = static_cast<double>(ticks) / interface.ticks_per_us;
    if (!(us < latest_us)) return "a packet from far in the future";
    auto& datagram = trace_.datagrams.emplace_back(datagram_of(payload));
    datagram.at = UtcTime(microseconds(std::llround(us)));
    datagram.client = find_option(cursor.rest(), option_comment).value_or("");
    return std::nullopt;
  }

  std::size_t at_ = 0;
  std::vector<Interface> interfaces_;
  Trace trace_;
};

}  // namespace

tl::expected<Trace, std::string> parse_trace_file(std::string_view contents) {
  return TraceReader().read(contents);
}

tl::expected<Trace, std::string> read_trace_file(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream contents;
  contents << file.rdbuf();
  if (!file.is_open() || file.bad() || errno == EISDIR)
    return tl::unexpected(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
  return parse_trace_file(contents.str()).map_error([&](const std::string& error) {
    return path + ": " + error;
  });
}

}  // namespace tmcl
