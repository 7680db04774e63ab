#include "fleet/fleet_place.hpp"

#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include <openssl/pem.h>
#include <openssl/x509.h>

#include <fmt/format.h>

#include "broker/address.hpp"
#include "broker/password_file.hpp"
#include "broker/topic_levels.hpp"

namespace tmclctl {
namespace {

Error bad_url(const std::string& url) {
  return usage_error("bad_url", fmt::format("'{}' names no broker", url),
                     "--fleet mqtts://broker.example, mqtts://HOST:PORT, or mqtt://USER@HOST "
                     "without TLS");
}

/// The common name in it, which a broker with use_identity_as_username calls its holder by.
Result<std::string> name_in_certificate(const std::string& path) {
  const auto failure = [&path](const char* why) {
    return tl::unexpected(usage_error("bad_certificate", fmt::format("{} {}", path, why)));
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "re"),
                                                             &std::fclose);
  if (!file) return failure("cannot be read");
  const std::unique_ptr<X509, void (*)(X509*)> certificate(
      PEM_read_X509(file.get(), nullptr, nullptr, nullptr), &X509_free);
  if (!certificate) return failure("is no certificate in PEM");
  std::array<char, tmclmqtt::max_level_bytes + 2> name{};
  if (X509_NAME_get_text_by_NID(X509_get_subject_name(certificate.get()), NID_commonName,
                                name.data(), static_cast<int>(name.size())) <= 0)
    return failure("has no common name");
  return std::string(name.data());
}

std::optional<std::string> taken_after(std::string& text, std::string_view scheme) {
  if (!text.starts_with(scheme)) return std::nullopt;
  return text.substr(scheme.size());
}

Result<void> find_user(const FleetPlace& place, BrokerPlace& broker) {
  broker.says_user = !broker.user.empty();
  if (!broker.says_user && !place.certificate_file.empty()) {
    auto name = name_in_certificate(place.certificate_file);
    if (!name) return tl::unexpected(std::move(name.error()));
    broker.user = std::move(*name);
  }
  if (broker.user.empty()) {
    return tl::unexpected(
        usage_error("no_user", "topics name the user, and none is known",
                    "--cert FILE with --key FILE, or a name in the URL: mqtts://USER@HOST"));
  }
  if (tmclmqtt::is_level(broker.user)) return {};
  return tl::unexpected(
      usage_error("bad_user", fmt::format("'{}' is no name that topics can have", broker.user),
                  "1 to 64 letters, digits, '_', '-', '.', '@'"));
}

}  // namespace

Result<BrokerPlace> find_broker(const FleetPlace& place) {
  BrokerPlace broker;
  auto rest = place.url;
  if (const auto secure = taken_after(rest, "mqtts://")) {
    broker.tls = true;
    rest = *secure;
  } else if (const auto plain = taken_after(rest, "mqtt://")) {
    rest = *plain;
  } else {
    return tl::unexpected(bad_url(place.url));
  }
  if (rest.ends_with('/')) rest.pop_back();
  if (const auto at = rest.rfind('@'); at != rest.npos) {
    broker.user = rest.substr(0, at);
    rest.erase(0, at + 1);
  }
  auto address =
      tmclmqtt::read_address(rest, broker.tls ? tmclmqtt::tls_port : tmclmqtt::plain_port);
  if (!address) return tl::unexpected(bad_url(place.url));
  broker.host = std::move(address->host);
  broker.port = address->port;
  if (!broker.tls && !(place.ca_file.empty() && place.certificate_file.empty()))
    return tl::unexpected(
        usage_error("bad_url", "--ca and --cert go with mqtts://: mqtt:// has no TLS"));
  if (auto found = find_user(place, broker); !found)
    return tl::unexpected(std::move(found.error()));
  if (place.password_file.empty()) return broker;
  auto password = tmclmqtt::password_in(place.password_file);
  if (!password) return tl::unexpected(usage_error("cannot_read", std::move(password.error())));
  broker.password = std::move(*password);
  return broker;
}

}  // namespace tmclctl
