/// Whether a request that came by HTTP is let in, as whom, and to what; decided by its head alone.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "api/caller.hpp"
#include "api/error.hpp"
#include "fronts/sign_ins.hpp"
#include "gateway/store/tokens.hpp"

namespace tmcld {

enum class HttpRoute : std::uint8_t {
  health,
  metrics,
  rpc,
  websocket,
  who,  ///< As whom a client is let in.
  sign_in,
  sign_out
};

/// What is looked at of the head of a request.
struct HttpHead {
  std::string_view method{};
  std::string_view target{};
  std::string_view host{};
  std::optional<std::string_view> origin{};
  std::string_view authorization{};
  std::string_view cookies{};
  std::string_view content_type{};
  std::string_view protocols{};  ///< Sec-WebSocket-Protocol
  bool is_upgrade = false;       ///< To a WebSocket.
};

/// How it came.
struct HttpConnectionInfo {
  std::string peer{};     ///< Address and port, for people.
  std::string network{};  ///< Whose addresses one client can have: an IPv4 address, or an IPv6 /64.
  bool is_loopback = false;  ///< Both ends are on this computer.
  bool has_tls = false;
  std::uint16_t port = 0;  ///< Of the daemon.
};

struct HttpEntry {
  HttpRoute route = HttpRoute::health;
  Caller caller{};
  std::string token{};        ///< By which it was let in; empty: by none.
  std::uint64_t sign_in = 0;  ///< By the cookie of which; 0: by none.
  std::string name{};         ///< Of the client, as others are told.
  std::string protocol{};     ///< Of the WebSocket, if it wants one; to be agreed on.
  bool is_invited = false;    ///< To sign in, once.
};

struct HttpRules {
  std::span<const std::string> origins{};
  bool loopback_without_token = false;
};

/// The WebSocket protocol of browsers, which carry their token in another one behind it:
/// new WebSocket(url, ["tmcl", "bearer.TOKEN"]).
constexpr std::string_view websocket_protocol = "tmcl";
constexpr std::string_view token_protocol_prefix = "bearer.";

/// A browser says on whose behalf it asks: its own pages may, and those of the configuration.
bool is_allowed_origin(std::string_view origin, std::string_view host, bool has_tls,
                       std::span<const std::string> allowed);
/// By which this computer is called from itself: no name that a page could have made point here.
bool is_loopback_host(std::string_view host, std::uint16_t port);
/// The token that came along; empty if none did.
std::string_view token_of(const HttpHead& head);
/// Of the cookie that stands for a token. Cookies are for all ports of a computer, so that the name
/// has the port; the beginning makes browsers take it by TLS only, and from this computer alone.
std::string cookie_name(const HttpConnectionInfo& connection);
/// What the cookie has; empty if none came along.
std::string_view cookie_of(const HttpHead& head, const HttpConnectionInfo& connection);

/// The client that came by the token of this name; empty: by none.
Caller caller_by(std::string_view token, const Tokens& tokens,
                 std::span<const AccessConfig> access);

/// `sign_in`: what the cookie stands for, if that has not ended. `invited_by`: the token whose
/// invitation came along instead of its secret; it lets a browser sign in, and no more.
Result<HttpEntry> admit_http(const HttpHead& head, const HttpConnectionInfo& connection,
                             const HttpRules& rules, const Tokens& tokens,
                             std::span<const AccessConfig> access,
                             const std::optional<SignIn>& sign_in = std::nullopt,
                             const std::optional<std::string>& invited_by = std::nullopt);
/// Of the answer to a request that is refused by this error.
unsigned http_status_of(const Error& refusal);

}  // namespace tmcld
