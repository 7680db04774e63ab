/// What many verbs are made of.
#pragma once

#include <algorithm>

#include "tmcl/script.hpp"

namespace tmcl::verbs {

/// An exchange that is done or not.
inline Script<Result<void>> act(Request request, CallOptions options = {}) {
  co_await must(exchange(request, options));
  co_return Result<void>{};
}

/// An exchange whose value is wanted.
inline Script<Result<std::int32_t>> ask(Request request, CallOptions options = {}) {
  const auto answer = co_await must(exchange(request, options));
  co_return answer.reply.value;
}

inline CallOptions with_proof(Proof proof, CallOptions options = {}) {
  options.proof = proof;
  return options;
}

/// What the module answers; nothing where it refuses to.
template <class T>
Script<Result<std::optional<T>>> unless_refused(Script<Result<T>> part) {
  auto result = co_await part;
  if (result) co_return std::optional<T>(*std::move(result));
  if (result.error().outcome == Outcome::refused) co_return std::optional<T>();
  co_return tl::unexpected(std::move(result.error()));
}

inline bool is_silence(const Error& error) {
  return error.code == Errc::reply_timeout || error.code == Errc::module_silent;
}

/// The module does not know the command, whatever it is about.
inline bool is_unknown_command(const Error& error) {
  return error.status == Status::invalid_command || error.status == Status::command_not_available;
}

/// Only a bootloader knows this command.
inline Script<Result<bool>> is_in_bootloader(ModuleAddress module, CallOptions options = {}) {
  const Request info{module, Command::BOOT_GET_INFO, 0, 0, 0};
  const auto answer = co_await must(unless_refused(ask(info, options)));
  co_return answer.has_value();
}

/// For exchanges of a verb that began at `begin` and is to end after `timeout`; zero: it may take
/// as long as it takes.
inline CallOptions until_timeout(TimePoint begin, Duration timeout) {
  CallOptions options;
  if (timeout > Duration{}) options.deadline = begin + timeout;
  return options;
}
inline bool is_over(const CallOptions& options, TimePoint now) {
  return options.deadline && now >= *options.deadline;
}
/// A pause after `now` that does not go on beyond the deadline.
inline Duration within_deadline(const CallOptions& options, TimePoint now, Duration pause) {
  if (!options.deadline) return pause;
  return std::clamp(*options.deadline - now, Duration{}, pause);
}
/// The deadline of the verb has kept this exchange from going out, or from being tried once more.
inline bool is_too_late(const CallOptions& options, const Error& error) {
  return options.deadline && error.code == Errc::deadline_passed;
}

}  // namespace tmcl::verbs
