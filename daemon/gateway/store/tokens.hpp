/// The tokens that let clients in from the network. Of each only a hash is kept.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <tl/expected.hpp>

#include "async/workers.hpp"
#include "config/config.hpp"
#include "gateway/store/invitations.hpp"
#include "log/sink.hpp"

namespace tmcld {

constexpr std::size_t most_tokens = 256;
constexpr std::size_t max_token_name_bytes = 32;

struct Token {
  std::string name;
  Role role = Role::observe;
  std::string made;  ///< "2026-11-23T01:35:12Z"
  std::string hash;  ///< SHA-256 of the secret, in hexadecimal digits.
};

/// Thread safety: none.
class Tokens {
 public:
  /// Empty path: they end with the process. A file that cannot be used lets no client in, and
  /// stays as it is.
  static std::shared_ptr<Tokens> open(std::string path, const LogSink& log);

  /// Why none can be added; empty if all is well.
  const std::string& problem() const { return problem_; }
  const std::vector<Token>& all() const { return all_; }
  /// Null if there is none.
  const Token* find(std::string_view name) const;
  const Token* of_secret(std::string_view secret) const;
  /// "token-1" or the next one that is free.
  std::string free_name() const;
  static bool is_name(std::string_view name);

  /// The secret, which cannot be read again. The name must be free, and there must be room.
  std::string add(std::string name, Role role);
  /// Ends the sessions that it let in, and its invitations.
  void remove(std::string_view name);
  Invitations& invitations() { return invitations_; }
  const Invitations& invitations() const { return invitations_; }
  /// The listener ends the connections that it let in.
  void on_removed(std::function<void(const std::string& name)> listener) {
    on_removed_ = std::move(listener);
  }

  /// Empty, or why what was changed is not kept.
  static boost::asio::awaitable<std::string> write(std::shared_ptr<Tokens> self);

 private:
  explicit Tokens(std::string path) : path_(std::move(path)) {}

  std::string path_;
  std::string problem_;
  std::vector<Token> all_;
  Invitations invitations_;
  std::function<void(const std::string& name)> on_removed_ = [](const std::string&) {};
  Workers writer_{1};
};

}  // namespace tmcld
