/// Numbers that the gateway gives out and takes back once each, soon: a call that brings one was
/// made not longer ago than that. No clock but the gateway's own is needed. Does no I/O, reads no
/// clock.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <string>
#include <string_view>

#include "tmcl/clock.hpp"

namespace tmclmqtt {

class Nonces {
 public:
  /// Those that one user can have at a time: a flood of one costs the others none of theirs.
  static constexpr std::size_t most_of_a_user = 16;
  static constexpr std::size_t most = 1024;

  /// `draw`: gives a text that nothing else gives and that cannot be guessed.
  Nonces(std::function<std::string()> draw, tmcl::Duration time_to_live)
      : draw_(std::move(draw)), time_to_live_(time_to_live) {}

  /// A new one; the oldest of the user makes room if there are many.
  std::string give(std::string_view user, tmcl::TimePoint now);
  /// True once, if the user was given it and its time is not over.
  bool take(std::string_view user, std::string_view nonce, tmcl::TimePoint now);
  /// What was given out is worth nothing any more.
  void forget() { given_.clear(); }
  tmcl::Duration time_to_live() const { return time_to_live_; }

 private:
  struct Given {
    std::string user;
    std::string nonce;
    tmcl::TimePoint at;
  };

  void drop_old(tmcl::TimePoint now);

  std::function<std::string()> draw_;
  tmcl::Duration time_to_live_;
  std::deque<Given> given_;  ///< The oldest first.
};

}  // namespace tmclmqtt
