#include "fronts/http_admission.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace tmcld {
namespace {

struct NamedStatus {
  std::string_view name;
  unsigned status;
};
constexpr unsigned bad_request = 400;
// Of those that are not simply bad requests.
constexpr auto statuses = std::to_array<NamedStatus>({{"no_token", 401},
                                                      {"unknown_token", 401},
                                                      {"wrong_host", 403},
                                                      {"foreign_origin", 403},
                                                      {"not_permitted", 403},
                                                      {"not_found", 404},
                                                      {"wrong_http_method", 405},
                                                      {"message_too_long", 413},
                                                      {"wrong_content_type", 415},
                                                      {"not_a_websocket", 426},
                                                      {"head_too_long", 431},
                                                      {"too_many_clients", 503},
                                                      {"daemon_ending", 503}});

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The first element of a list, which is taken off it.
std::string_view take_element(std::string_view& list) {
  const auto end = list.find(',');
  const auto element = trimmed(list.substr(0, end));
  list = end == std::string_view::npos ? std::string_view{} : list.substr(end + 1);
  return element;
}

bool lists(std::string_view list, std::string_view wanted) {
  while (!list.empty()) {
    if (take_element(list) == wanted) return true;
  }
  return false;
}

// A client from the network is no user of this computer.
constexpr std::uint32_t uid_of_nobody = 65534;

Caller caller_with_token(const Token& token) {
  Caller caller{{uid_of_nobody}, token.role, "by the token '" + token.name + "'"};
  caller.exceeds_limits = token.role == Role::configure;
  return caller;
}

/// A client of this computer without a token: its user is unknown.
Caller unknown_caller(std::span<const AccessConfig> access) {
  Caller caller{{uid_of_nobody}};
  if (access.empty()) return caller;
  caller.role = Role::stop;
  caller.reason = "it has no token, and [[access]] is by users and groups";
  return caller;
}

struct Place {
  std::string_view path;
  std::string_view method;
  HttpRoute route;
};
constexpr auto places = std::to_array<Place>({
    {"/healthz", "GET", HttpRoute::health},
    {"/metrics", "GET", HttpRoute::metrics},
    {"/rpc", "POST", HttpRoute::rpc},
    {"/ws", "GET", HttpRoute::websocket},
});

Result<HttpRoute> route_of(const HttpHead& head) {
  const auto path = head.target.substr(0, head.target.find('?'));
  const auto* place = std::ranges::find(places, path, &Place::path);
  if (place == places.end()) {
    return tl::unexpected(not_now("not_found", "there is nothing here",
                                  "/rpc, /ws, /metrics and /healthz are served"));
  }
  if (head.method != place->method) {
    return tl::unexpected(not_now("wrong_http_method",
                                  std::string(path) + " is for " + std::string(place->method),
                                  "one JSON-RPC message in the body of a POST to /rpc"));
  }
  if (place->route == HttpRoute::websocket && !head.is_upgrade) {
    return tl::unexpected(
        not_now("not_a_websocket", "/ws is for WebSockets", "single calls: POST /rpc"));
  }
  return place->route;
}

/// A page of another site could send text to here, but no JSON without being asked first.
std::optional<Error> objection_to_type(const HttpHead& head) {
  const auto type = lower(trimmed(head.content_type.substr(0, head.content_type.find(';'))));
  if (type == "application/json") return std::nullopt;
  return not_now("wrong_content_type", "a call is of the type application/json",
                 "send 'Content-Type: application/json'; curl does with --json");
}

Error unauthorized(std::string_view name, std::string message) {
  return not_now(
      name, std::move(message),
      "send 'Authorization: Bearer TOKEN'; the method token.add makes one, on tmcld's socket");
}

Result<HttpEntry> entry_without_token(const HttpHead& head, const HttpConnectionInfo& connection,
                                      const HttpRules& rules,
                                      std::span<const AccessConfig> access) {
  if (!connection.is_loopback || !rules.loopback_without_token)
    return tl::unexpected(unauthorized("no_token", "no client is let in without a token"));
  if (!is_loopback_host(head.host, connection.port)) {
    return tl::unexpected(not_now(
        "wrong_host",
        "without a token only this computer is let in, by the name localhost, not '" +
            std::string(head.host) + "'",
        "ask for http://localhost:" + std::to_string(connection.port) + ", or send a token"));
  }
  return HttpEntry{
      HttpRoute::rpc, unknown_caller(access), {}, "a program at " + connection.peer, {}};
}

Result<HttpEntry> entry_by_token(std::string_view secret, const HttpConnectionInfo& connection,
                                 const Tokens& tokens) {
  const auto* token = tokens.of_secret(secret);
  if (token == nullptr) {
    return tl::unexpected(unauthorized("unknown_token",
                                       "there is no such token: it was revoked, or is of another "
                                       "tmcld"));
  }
  return HttpEntry{HttpRoute::rpc,
                   caller_with_token(*token),
                   token->name,
                   "token '" + token->name + "' from " + connection.peer,
                   {}};
}

}  // namespace

bool is_allowed_origin(std::string_view origin, std::string_view host, bool has_tls,
                       std::span<const std::string> allowed) {
  const auto asking = lower(origin);
  if (!host.empty() && asking == (has_tls ? "https://" : "http://") + lower(host)) return true;
  return std::ranges::any_of(allowed, [&](const auto& one) { return lower(one) == asking; });
}

bool is_loopback_host(std::string_view host, std::uint16_t port) {
  constexpr std::uint16_t port_of_http = 80;
  constexpr std::uint16_t port_of_https = 443;
  const auto asked = lower(host);
  const auto suffix = ":" + std::to_string(port);
  const bool may_omit = port == port_of_http || port == port_of_https;
  return std::ranges::any_of(std::array<std::string, 3>{"localhost", "127.0.0.1", "[::1]"},
                             [&](const std::string& name) {
                               return asked == name + suffix || (may_omit && asked == name);
                             });
}

std::string_view token_of(const HttpHead& head) {
  constexpr std::string_view scheme = "bearer ";
  const auto said = trimmed(head.authorization);
  if (lower(said.substr(0, scheme.size())) == scheme) return trimmed(said.substr(scheme.size()));
  auto protocols = head.protocols;
  while (!protocols.empty()) {
    const auto protocol = take_element(protocols);
    if (protocol.starts_with(token_protocol_prefix))
      return protocol.substr(token_protocol_prefix.size());
  }
  return {};
}

Caller caller_by(std::string_view token, const Tokens& tokens,
                 std::span<const AccessConfig> access) {
  if (token.empty()) return unknown_caller(access);
  const auto* found = tokens.find(token);
  if (found != nullptr) return caller_with_token(*found);
  return {{uid_of_nobody}, Role::stop, "the token '" + std::string(token) + "' was revoked"};
}

Result<HttpEntry> admit_http(const HttpHead& head, const HttpConnectionInfo& connection,
                             const HttpRules& rules, const Tokens& tokens,
                             std::span<const AccessConfig> access) {
  const auto route = route_of(head);
  if (!route) return tl::unexpected(route.error());
  if (*route == HttpRoute::health) return HttpEntry{};
  const auto& origin = head.origin;
  if (origin && !is_allowed_origin(*origin, head.host, connection.has_tls, rules.origins)) {
    return tl::unexpected(not_now("foreign_origin",
                                  "pages of " + std::string(*origin) + " may not call this tmcld",
                                  "'origins' in [http] of tmcld.toml names the pages that may"));
  }
  const auto secret = token_of(head);
  auto entry = secret.empty() ? entry_without_token(head, connection, rules, access)
                              : entry_by_token(secret, connection, tokens);
  if (!entry) return entry;
  if (*route == HttpRoute::rpc) {
    if (auto refused = objection_to_type(head)) return tl::unexpected(std::move(*refused));
  }
  if (*route == HttpRoute::metrics && entry->caller.role < Role::observe) {
    return tl::unexpected(
        not_now("not_permitted", "/metrics needs the role 'observe'", "send a token of that role"));
  }
  entry->route = *route;
  if (lists(head.protocols, websocket_protocol)) entry->protocol = websocket_protocol;
  return entry;
}

unsigned http_status_of(const Error& refusal) {
  const auto* own = std::ranges::find(statuses, refusal.name, &NamedStatus::name);
  return own == statuses.end() ? bad_request : own->status;
}

}  // namespace tmcld
