#include "config/build_http.hpp"

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

struct SectionProblems {
  const ConfigSection& section;
  tmcl::TextProblems& all;

  void add(std::string_view key, std::string message) const {
    all.push_back(section.place_of(key).problem(std::move(message)));
  }
};

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

void add_addresses(const SectionProblems& problems, HttpConfig& http) {
  const auto* texts = problems.section.get<ConfigTexts>("listen");
  if (texts == nullptr) return;
  if (texts->empty() || texts->size() > max_listen_addresses)
    problems.add("listen",
                 "'listen' must name 1.." + std::to_string(max_listen_addresses) + " addresses");
  for (const auto& text : *texts) {
    auto address = address_of(text);
    if (address) http.listen.push_back(std::move(*address));
    if (address) continue;
    problems.add("listen", quoted(text) +
                               " is no address of this computer with a port, in numbers, such as "
                               "127.0.0.1:4143, 0.0.0.0:4143 or [::1]:4143");
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

void add_origins(const SectionProblems& problems, HttpConfig& http) {
  const auto* texts = problems.section.get<ConfigTexts>("origins");
  if (texts == nullptr) return;
  if (texts->size() > max_origins)
    problems.add("origins", "'origins' may name " + std::to_string(max_origins));
  for (const auto& text : *texts) {
    if (is_origin(text)) http.origins.push_back(text);
    if (is_origin(text)) continue;
    problems.add("origins", quoted(text) +
                                " is no origin: write it as the browser does, such as "
                                "https://bench.example or http://localhost:8080");
  }
}

void check_tls(const SectionProblems& problems, const HttpConfig& http) {
  if (http.certificate.empty() != http.key.empty())
    problems.add(http.key.empty() ? "certificate" : "key",
                 "'certificate' and 'key' go together: one of them is missing");
  if (!http.client_ca.empty() && http.certificate.empty())
    problems.add("client_ca", "'client_ca' needs a 'certificate' and a 'key' of the daemon, too");
  const auto outward =
      std::ranges::find_if(http.listen, [](const HttpAddress& one) { return !one.is_loopback; });
  if (outward == http.listen.end() || !http.certificate.empty()) return;
  problems.add("listen",
               outward->host +
                   " is to be reached from other computers: that needs a 'certificate' and its "
                   "'key', or tokens could be read on the way. Without one: 127.0.0.1");
}

}  // namespace

HttpConfig build_http(const ConfigSection& section, tmcl::TextProblems& problems) {
  HttpConfig http;
  const SectionProblems into{section, problems};
  add_addresses(into, http);
  add_origins(into, http);
  const auto text = [&](std::string_view key) {
    const auto* said = section.get<std::string>(key);
    if (said != nullptr && said->empty())
      into.add(key, quoted(key) + " must be the path of a file");
    return said == nullptr ? std::string() : *said;
  };
  http.certificate = text("certificate");
  http.key = text("key");
  http.client_ca = text("client_ca");
  if (const auto* flag = section.get<bool>("loopback_without_token"))
    http.loopback_without_token = *flag;
  check_tls(into, http);
  return http;
}

}  // namespace tmcld
