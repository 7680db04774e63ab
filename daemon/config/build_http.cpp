#include "config/build.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>

#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

constexpr std::size_t max_listen_addresses = 8;
constexpr std::size_t max_origins = 16;
constexpr std::uint8_t first_byte_of_loopback = 127;

std::optional<std::uint16_t> port_of(std::string_view text) {
  std::uint16_t port = 0;
  const auto* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, port);
  return read.ec == std::errc() && read.ptr == end ? std::optional(port) : std::nullopt;
}

std::optional<HttpAddress> address_of(std::string_view text) {
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const auto port = port_of(text.substr(colon + 1));
  auto host = std::string(text.substr(0, colon));
  if (!port) return std::nullopt;
  if (host == "localhost") host = "127.0.0.1";
  in_addr four{};
  if (::inet_pton(AF_INET, host.c_str(), &four) == 1) {
    const bool is_loopback = ntohl(four.s_addr) >> 24U == first_byte_of_loopback;
    return HttpAddress{std::move(host), *port, is_loopback};
  }
  if (host.size() < 2 || host.front() != '[' || host.back() != ']') return std::nullopt;
  host = host.substr(1, host.size() - 2);
  in6_addr six{};
  if (::inet_pton(AF_INET6, host.c_str(), &six) != 1) return std::nullopt;
  return HttpAddress{std::move(host), *port, IN6_IS_ADDR_LOOPBACK(&six) != 0};
}

/// What is wrong goes to `problems`, here and below.
void add_addresses(const Said<ConfigTexts>& texts, HttpConfig& http, tmcl::TextProblems& problems) {
  if (!texts) return;
  if (texts->empty() || texts->size() > max_listen_addresses)
    problems.push_back(texts.problem("'listen' must name 1.." +
                                     std::to_string(max_listen_addresses) + " addresses"));
  for (const auto& text : *texts) {
    auto address = address_of(text);
    if (address) http.listen.push_back(std::move(*address));
    if (address) continue;
    problems.push_back(
        texts.problem(quoted(text) +
                      " is no address of this computer with a port, in numbers, such as "
                      "127.0.0.1:4143, 0.0.0.0:4143 or [::1]:4143"));
  }
}

bool is_origin(std::string_view text) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!text.starts_with(scheme)) continue;
    const auto host = text.substr(scheme.size());
    return !host.empty() && host.find_first_of("/?# *") == std::string_view::npos;
  }
  return false;
}

void add_origins(const Said<ConfigTexts>& texts, HttpConfig& http, tmcl::TextProblems& problems) {
  if (!texts) return;
  if (texts->size() > max_origins)
    problems.push_back(texts.problem("'origins' may name " + std::to_string(max_origins)));
  for (const auto& text : *texts) {
    if (is_origin(text)) http.origins.push_back(text);
    if (is_origin(text)) continue;
    problems.push_back(texts.problem(quoted(text) +
                                     " is no origin: write it as the browser does, such as "
                                     "https://bench.example or http://localhost:8080"));
  }
}

void set_path(const Said<std::string>& path, std::string& target, tmcl::TextProblems& problems) {
  if (path && path->empty())
    problems.push_back(path.problem(quoted(path.key) + " must be the path of a file"));
  target = path.value_or("");
}

void check_tls(const HttpSection& section, const HttpConfig& http, tmcl::TextProblems& problems) {
  if (http.certificate.empty() != http.key.empty()) {
    const auto& alone = http.key.empty() ? section.certificate : section.key;
    problems.push_back(
        alone.problem("'certificate' and 'key' go together: one of them is missing"));
  }
  if (!http.client_ca.empty() && http.certificate.empty())
    problems.push_back(section.client_ca.problem(
        "'client_ca' needs a 'certificate' and a 'key' of the daemon, too"));
  const auto outward =
      std::ranges::find_if(http.listen, [](const HttpAddress& one) { return !one.is_loopback; });
  if (outward == http.listen.end() || !http.certificate.empty()) return;
  problems.push_back(section.listen.problem(
      outward->host +
      " is to be reached from other computers: that needs a 'certificate' and its 'key', or "
      "tokens could be read on the way. Without one: 127.0.0.1"));
}

}  // namespace

HttpConfig build_http(const HttpSection& section, tmcl::TextProblems& problems) {
  HttpConfig http;
  add_addresses(section.listen, http, problems);
  add_origins(section.origins, http, problems);
  set_path(section.certificate, http.certificate, problems);
  set_path(section.key, http.key, problems);
  set_path(section.client_ca, http.client_ca, problems);
  http.loopback_without_token = section.loopback_without_token.value_or(false);
  set_path(section.page, http.page, problems);
  check_tls(section, http, problems);
  return http;
}

}  // namespace tmcld
