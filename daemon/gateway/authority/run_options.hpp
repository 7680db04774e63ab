/// How a verb is run on a bus: for which call, and what has to hold when its commands go out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "gateway/authority/judge.hpp"
#include "gateway/module/sentinel.hpp"
#include "tmcl/bus.hpp"

namespace tmcld {

/// What a movement was admitted on, and that may change before it goes out.
struct Premise {
  /// It has changed since the last check.
  std::function<bool()> has_changed{};
  /// Checks it anew.
  std::function<tmcl::Script<tmcl::Result<void>>()> check{};
};

struct RunOptions : tmcl::RunOptions {
  /// Of the call that it is for: see Motors.
  Permit permit{};
  /// What a movement was checked against, such as soft limits.
  Premise premise{};
  /// What the verb sends, if that may set a motor turning without end: before it goes out, that has
  /// an owner, and the journal says so.
  std::optional<tmcl::Request> announced{};
  /// How lately a module must have been seen to be what it was, when something goes out that can
  /// move it.
  tmcl::Duration sentinel_age = movement_sentinel_age;
};

/// For what needs no permit.
inline RunOptions asked_by(std::uint64_t client) {
  RunOptions options;
  options.permit.client = client;
  return options;
}
/// The same, for what has no use when the client has gone.
inline RunOptions only_asked_by(std::uint64_t client) {
  auto options = asked_by(client);
  options.permit.only_asks = true;
  return options;
}

}  // namespace tmcld
