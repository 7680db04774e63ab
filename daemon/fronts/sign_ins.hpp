/// Browsers that have shown a token once. Each has a secret of its own instead, in a cookie: no
/// script can read it, and it ends by itself.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/clock.hpp"

namespace tmcld {

/// Of one token; the oldest gives way to another.
constexpr std::size_t most_sign_ins_of_a_token = 64;
constexpr std::chrono::hours time_signed_in{24};

struct SignIn {
  std::uint64_t id = 0;
  std::string token{};  ///< Name of the one that was shown.
  tmcl::TimePoint ends{};
};

/// Thread safety: none.
class SignIns {
 public:
  /// The secret, which cannot be read again.
  std::string add(std::string token, tmcl::TimePoint now);
  /// Nothing if there is none, or if it has ended.
  std::optional<SignIn> of_secret(std::string_view secret, tmcl::TimePoint now) const;
  bool is_in(std::uint64_t id, tmcl::TimePoint now) const;
  void remove(std::uint64_t id);
  void remove_of_token(std::string_view token);
  /// Takes those away that have ended.
  std::vector<SignIn> take_ended(tmcl::TimePoint now);

 private:
  struct Known : SignIn {
    std::string hash{};
  };
  std::uint64_t last_id_ = 0;
  std::vector<Known> all_;  ///< Oldest first.
};

}  // namespace tmcld
