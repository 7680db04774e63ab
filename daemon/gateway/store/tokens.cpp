#include "gateway/store/tokens.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include <boost/json/parse.hpp>
#include <boost/json/value_to.hpp>

#include "async/elsewhere.hpp"
#include "gateway/store/secret.hpp"
#include "gateway/store/state_file.hpp"
#include "tmcl/json_text.hpp"
#include "tmcl/utc_text.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;

// So that scanners for lost secrets, and people, know what it is.
constexpr std::string_view prefix = "tmcl_";

std::optional<Role> role_named(std::string_view name) {
  const auto found = std::ranges::find(role_names, name);
  if (found == role_names.end()) return std::nullopt;
  return static_cast<Role>(found - role_names.begin());
}

json::object to_json(const Token& token) {
  return {{"name", token.name},
          {"role", name_of(token.role)},
          {"made", token.made},
          {"sha256", token.hash}};
}

/// Throws if it is none.
Token token_from(const json::value& value) {
  const auto text = [&](const char* key) { return json::value_to<std::string>(value.at(key)); };
  const auto role = role_named(text("role"));
  if (!role) throw std::runtime_error("a role is '" + text("role") + "'");
  return {text("name"), *role, text("made"), text("sha256")};
}

tl::expected<std::vector<Token>, std::string> read_tokens(const std::string& path) {
  const auto text = read_state_file(path);
  if (!text) return tl::unexpected(text.error());
  std::vector<Token> all;
  if (!*text) return all;
  try {
    const auto document = json::parse(**text);
    for (const auto& one : document.at("tokens").as_array()) all.push_back(token_from(one));
    return all;
  } catch (const std::exception& error) {
    return tl::unexpected(path + " is damaged: " + error.what());
  }
}

std::string text_of(const std::vector<Token>& all) {
  json::array array;
  for (const auto& token : all) array.push_back(to_json(token));
  return tmcl::json_text(json::object{{"version", 1}, {"tokens", std::move(array)}}) + "\n";
}

}  // namespace

std::shared_ptr<Tokens> Tokens::open(std::string path, const LogSink& log) {
  std::shared_ptr<Tokens> tokens(new Tokens(std::move(path)));
  if (tokens->path_.empty()) return tokens;
  auto known = read_tokens(tokens->path_);
  if (known) tokens->all_ = std::move(*known);
  if (known) return tokens;
  tokens->problem_ = known.error();
  log(LogLevel::error, "no token lets a client in: " + tokens->problem_);
  return tokens;
}

const Token* Tokens::find(std::string_view name) const {
  const auto found = std::ranges::find(all_, name, &Token::name);
  return found == all_.end() ? nullptr : &*found;
}

const Token* Tokens::of_secret(std::string_view secret) const {
  if (!secret.starts_with(prefix)) return nullptr;
  const auto found = std::ranges::find(all_, hash_of(secret), &Token::hash);
  return found == all_.end() ? nullptr : &*found;
}

std::string Tokens::free_name() const {
  for (std::size_t number = 1;; ++number) {
    auto name = "token-" + std::to_string(number);
    if (find(name) == nullptr) return name;
  }
}

bool Tokens::is_name(std::string_view name) {
  constexpr std::string_view allowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  return !name.empty() && name.size() <= max_token_name_bytes &&
         name.find_first_not_of(allowed) == std::string_view::npos;
}

std::string Tokens::add(std::string name, Role role) {
  auto secret = std::string(prefix) + new_secret();
  all_.push_back(
      {std::move(name), role, tmcl::to_text(tmcl::RealClock::utc(), 0), hash_of(secret)});
  return secret;
}

void Tokens::remove(std::string_view name) {
  const std::string gone(name);
  std::erase_if(all_, [&](const Token& token) { return token.name == gone; });
  invitations_.remove_of_token(gone);
  on_removed_(gone);
}

boost::asio::awaitable<std::string> Tokens::write(std::shared_ptr<Tokens> self) {
  if (self->path_.empty()) co_return std::string();
  auto work = [path = self->path_, text = text_of(self->all_)] {
    return replace_state_file(path, text);
  };
  auto failure = co_await elsewhere(self->writer_, std::move(work));
  co_return failure;
}

}  // namespace tmcld
