#include "log/journald.hpp"

#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <optional>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace tmcld {
namespace {

struct Word {
  std::string_view begin;  ///< What stands before the value.
  const char* field;
};
constexpr auto words = std::to_array<Word>({{"client=", "TMCL_CLIENT"},
                                            {"method=", "TMCL_METHOD"},
                                            {"outcome=", "TMCL_OUTCOME"},
                                            {"error=", "TMCL_ERROR"},
                                            {"bus=", "TMCL_BUS"},
                                            {"\"bus\":", "TMCL_BUS"},
                                            {"\"axis\":", "TMCL_AXIS"}});

/// In quotes, or up to the next blank, comma or brace.
std::string_view value_at(std::string_view text) {
  if (text.starts_with('"')) return text.substr(1, text.find('"', 1) - 1);
  return text.substr(0, text.find_first_of(" ,}]"));
}

std::optional<std::string_view> value_behind(std::string_view line, std::string_view begin) {
  for (auto at = line.find(begin); at != std::string_view::npos; at = line.find(begin, at + 1)) {
    constexpr std::string_view before = " {,";
    if (at == 0 || before.find(line[at - 1]) != std::string_view::npos)
      return value_at(line.substr(at + begin.size()));
  }
  return std::nullopt;
}

// Its length is said before it, so that it may be anything.
void add_field(std::string& entry, std::string_view name, std::string_view value) {
  static_assert(std::endian::native == std::endian::little);
  const std::uint64_t size = value.size();
  entry += name;
  entry += '\n';
  entry.append(reinterpret_cast<const char*>(&size), sizeof size);
  entry += value;
  entry += '\n';
}

}  // namespace

std::vector<std::pair<std::string, std::string>> journald_fields(std::string_view line) {
  std::vector<std::pair<std::string, std::string>> fields;
  for (const auto& [begin, field] : words) {
    const auto value = value_behind(line, begin);
    const bool is_said = !fields.empty() && fields.back().first == field;
    if (value && !value->empty() && !is_said) fields.emplace_back(field, *value);
  }
  return fields;
}

std::string journald_entry(int priority, std::string_view line) {
  std::string entry;
  add_field(entry, "PRIORITY", std::to_string(priority));
  add_field(entry, "SYSLOG_IDENTIFIER", "tmcld");
  for (const auto& [name, value] : journald_fields(line)) add_field(entry, name, value);
  add_field(entry, "MESSAGE", line);
  return entry;
}

JournaldSocket::JournaldSocket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return;
  path.copy(address.sun_path, path.size());
  descriptor_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0) return;
  if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return;
  ::close(descriptor_);
  descriptor_ = -1;
}

JournaldSocket::~JournaldSocket() {
  if (is_there()) ::close(descriptor_);
}

bool JournaldSocket::send(std::string_view entry) const {
  ssize_t sent = 0;
  do {
    sent = ::send(descriptor_, entry.data(), entry.size(), MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  return sent >= 0;
}

}  // namespace tmcld
