/// What many verbs are made of.
#pragma once

#include "tmcl/script.hpp"

namespace tmcl::verbs {

/// An exchange that is done or not.
inline Script<Result<void>> act(Request request) {
  const auto answer = co_await exchange(request);
  if (!answer) co_return tl::unexpected(answer.error());
  co_return Result<void>{};
}

/// An exchange whose value is wanted.
inline Script<Result<std::int32_t>> ask(Request request) {
  const auto answer = co_await exchange(request);
  if (!answer) co_return tl::unexpected(answer.error());
  co_return answer->reply.value;
}

inline bool is_silence(const Error& error) {
  return error.code == Errc::reply_timeout || error.code == Errc::module_silent;
}

}  // namespace tmcl::verbs
