#include "fronts/http_admission.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "fronts/header_list.hpp"

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
                                                      {"sign_in_ended", 401},
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
    {"/session", "GET", HttpRoute::who},
    {"/session", "POST", HttpRoute::sign_in},
    {"/session", "DELETE", HttpRoute::sign_out},
});

Error wrong_method(std::string_view path) {
  std::string methods;
  for (const auto& place : places) {
    if (place.path != path) continue;
    if (!methods.empty()) methods += ", ";
    methods += place.method;
  }
  return not_now("wrong_http_method", std::string(path) + " is for " + methods,
                 "one JSON-RPC message in the body of a POST to /rpc");
}

Result<HttpRoute> route_of(const HttpHead& head) {
  const auto path = head.target.substr(0, head.target.find('?'));
  if (std::ranges::find(places, path, &Place::path) == places.end()) {
    return tl::unexpected(
        not_now("not_found", "there is nothing here",
                "/rpc, /ws, /session, /metrics and /healthz are served, and a page at /"));
  }
  const auto* place = std::ranges::find_if(
      places, [&](const Place& one) { return one.path == path && one.method == head.method; });
  if (place == places.end()) return tl::unexpected(wrong_method(path));
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
      HttpRoute::rpc, unknown_caller(access), {}, 0, "a program at " + connection.peer, {}};
}

HttpEntry entry_of(const Token& token, std::uint64_t sign_in,
                   const HttpConnectionInfo& connection) {
  return {HttpRoute::rpc,
          caller_with_token(token),
          token.name,
          sign_in,
          "token '" + token.name + "' from " + connection.peer,
          {}};
}

Result<HttpEntry> entry_by_token(std::string_view secret, const HttpConnectionInfo& connection,
                                 const Tokens& tokens) {
  const auto* token = tokens.of_secret(secret);
  if (token == nullptr) {
    return tl::unexpected(unauthorized("unknown_token",
                                       "there is no such token: it was revoked, or is of another "
                                       "tmcld"));
  }
  return entry_of(*token, 0, connection);
}

Result<HttpEntry> entry_by_cookie(const std::optional<SignIn>& sign_in,
                                  const HttpConnectionInfo& connection, const Tokens& tokens) {
  const auto* token = sign_in ? tokens.find(sign_in->token) : nullptr;
  if (token == nullptr) {
    return tl::unexpected(not_now("sign_in_ended", "the sign-in has ended",
                                  "sign in again: POST /session with a token"));
  }
  return entry_of(*token, sign_in->id, connection);
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

std::string cookie_name(const HttpConnectionInfo& connection) {
  return (connection.has_tls ? "__Host-tmcl-" : "tmcl-") + std::to_string(connection.port);
}

std::string_view cookie_of(const HttpHead& head, const HttpConnectionInfo& connection) {
  const auto beginning = cookie_name(connection) + "=";
  auto cookies = head.cookies;
  while (!cookies.empty()) {
    const auto cookie = take_element(cookies, ';');
    if (cookie.starts_with(beginning)) return cookie.substr(beginning.size());
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
                             std::span<const AccessConfig> access,
                             const std::optional<SignIn>& sign_in,
                             const std::optional<std::string>& invited_by) {
  const auto route = route_of(head);
  if (!route) return tl::unexpected(route.error());
  if (*route == HttpRoute::health) return HttpEntry{};
  const auto& origin = head.origin;
  if (origin && !is_allowed_origin(*origin, head.host, connection.has_tls, rules.origins)) {
    return tl::unexpected(not_now("foreign_origin",
                                  "pages of " + std::string(*origin) + " may not call this tmcld",
                                  "'origins' in [http] of tmcld.toml names the pages that may"));
  }
  // Whose sign-in has ended can still have its cookie taken away.
  if (*route == HttpRoute::sign_out)
    return HttpEntry{*route, {}, {}, sign_in ? sign_in->id : 0, {}, {}};
  const auto secret = token_of(head);
  if (*route == HttpRoute::sign_in && secret.empty())
    return tl::unexpected(unauthorized("no_token", "a sign-in shows a token"));
  const bool has_cookie = !cookie_of(head, connection).empty();
  const auto* inviting = invited_by ? tokens.find(*invited_by) : nullptr;
  const bool is_invited = *route == HttpRoute::sign_in && inviting != nullptr;
  auto entry = is_invited        ? Result<HttpEntry>(entry_of(*inviting, 0, connection))
               : !secret.empty() ? entry_by_token(secret, connection, tokens)
               : has_cookie      ? entry_by_cookie(sign_in, connection, tokens)
                                 : entry_without_token(head, connection, rules, access);
  if (!entry) return entry;
  if (*route == HttpRoute::rpc) {
    if (auto refused = objection_to_type(head)) return tl::unexpected(std::move(*refused));
  }
  if (*route == HttpRoute::metrics && entry->caller.role < Role::observe) {
    return tl::unexpected(
        not_now("not_permitted", "/metrics needs the role 'observe'", "send a token of that role"));
  }
  entry->route = *route;
  entry->is_invited = is_invited;
  if (lists(head.protocols, websocket_protocol)) entry->protocol = websocket_protocol;
  return entry;
}

unsigned http_status_of(const Error& refusal) {
  const auto* own = std::ranges::find(statuses, refusal.name, &NamedStatus::name);
  return own == statuses.end() ? bad_request : own->status;
}

}  // namespace tmcld
