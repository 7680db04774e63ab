/// Secrets by which a browser signs in once, soon, instead of by the token itself.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/clock.hpp"

namespace tmcld {

/// The oldest gives way to another.
constexpr std::size_t most_invitations = 64;
constexpr std::chrono::minutes time_invited{10};

/// They end with the process. Thread safety: none.
class Invitations {
 public:
  /// The secret, which cannot be read again. `token`: name of the token that it stands for.
  std::string add(std::string token, tmcl::TimePoint now);
  /// Name of the token; nothing if there is no such invitation, or if it was used or has ended.
  std::optional<std::string> token_by(std::string_view secret, tmcl::TimePoint now) const;
  void use(std::string_view secret);
  void remove_of_token(std::string_view token);

 private:
  struct Known {
    std::string hash;
    std::string token;
    tmcl::TimePoint ends;
  };
  std::vector<Known> all_;  ///< Oldest first.
};

}  // namespace tmcld
