#include "api/token_handlers.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "api/suggest.hpp"
#include "api/token_keeper.hpp"
#include "gateway/store/tokens.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

/// Those that a token can give: a stop is everybody's.
constexpr auto roles = std::span(role_names).subspan(1);

/// Null if the front of the call knows none.
std::shared_ptr<tmcld::Tokens> tokens_of(const Call& call) {
  const auto* keeper = dynamic_cast<const TokenKeeper*>(call.peer.get());
  return keeper == nullptr ? nullptr : keeper->tokens();
}

/// Nothing if tokens can be made and revoked.
std::optional<Error> objection(const Call& call) {
  const auto tokens = tokens_of(call);
  if (!tokens)
    return not_now("no_tokens", "this gateway lets no client in by a token",
                   "tokens are for clients of a running tmcld");
  if (tokens->problem().empty()) return std::nullopt;
  return not_now("no_tokens", "the file of the tokens cannot be used: " + tokens->problem(),
                 "put it right, or move it away; then start tmcld again");
}

Result<Role> role_of(const token::Add& params) {
  const auto found = std::ranges::find(roles, params.role);
  if (found != roles.end()) return static_cast<Role>(found - roles.begin() + 1);
  return tl::unexpected(param_error<&token::Add::role>(
      "bad_argument", "'role' is observe, operate or configure", suggest(params.role, roles)));
}

Result<std::string> name_of(const token::Add& params, const tmcld::Tokens& tokens) {
  const auto refuse = [](std::string message) {
    return tl::unexpected(param_error<&token::Add::name>("bad_argument", std::move(message)));
  };
  if (tokens.all().size() >= most_tokens)
    return refuse("there are " + std::to_string(most_tokens) +
                  " tokens, and no more than that: revoke one that is not needed");
  const auto name = params.name.value_or(tokens.free_name());
  if (!tmcld::Tokens::is_name(name))
    return refuse("the name of a token has 1 to " + std::to_string(max_token_name_bytes) +
                  " letters, digits, '_', '-', '.'");
  if (tokens.find(name) != nullptr) return refuse("there is a token '" + name + "' already");
  return name;
}

/// `param`: of the method, for the error.
template <auto param>
Result<Token> token_named(const std::string& name, const tmcld::Tokens& tokens) {
  if (const auto* found = tokens.find(name)) return *found;
  std::vector<std::string_view> names;
  for (const auto& one : tokens.all()) names.push_back(one.name);
  return tl::unexpected(param_error<param>("bad_argument", "there is no token '" + name + "'",
                                           suggest(name, names, "token.list shows them")));
}

Error not_kept(const std::string& why, std::string message) {
  return failed("not_kept", std::move(message) + ": " + why,
                "look at the directory of tmcld's state: is there room, and may it write?");
}

}  // namespace

Answer<token::Add> add_token(Call& call, const token::Add& params) {
  co_await must_not(objection(call));
  const auto tokens = tokens_of(call);
  const auto role = co_await must(role_of(params));
  const auto name = co_await must(name_of(params, *tokens));
  auto secret = tokens->add(name, role);
  const auto failure = co_await tmcld::Tokens::write(tokens);
  if (failure.empty()) co_return token::Added{name, params.role, std::move(secret)};
  tokens->remove(name);
  co_return not_kept(failure, "the token was not made");
}

Answer<token::List> list_tokens(Call& call, const token::List&) {
  co_await must_not(objection(call));
  token::Tokens result;
  for (const auto& one : tokens_of(call)->all())
    result.tokens.push_back({one.name, std::string(tmcld::name_of(one.role)), one.made});
  co_return result;
}

Answer<token::Invite> invite_by_token(Call& call, const token::Invite& params) {
  co_await must_not(objection(call));
  const auto tokens = tokens_of(call);
  const auto token = co_await must(token_named<&token::Invite::name>(params.name, *tokens));
  auto code = tokens->invitations().add(token.name, call.gateway->clock().now());
  co_return token::Invited{token.name, std::string(tmcld::name_of(token.role)), std::move(code),
                           tmcl::seconds(time_invited)};
}

Answer<token::Revoke> revoke_token(Call& call, const token::Revoke& params) {
  co_await must_not(objection(call));
  const auto tokens = tokens_of(call);
  co_await must(token_named<&token::Revoke::name>(params.name, *tokens));
  tokens->remove(params.name);
  const auto failure = co_await tmcld::Tokens::write(tokens);
  if (failure.empty()) co_return Nothing{};
  co_return not_kept(failure, "it is revoked, but would be good again if tmcld were started again");
}

}  // namespace tmcld::handlers
