/// What has to reach the axes when a line or path ends, also where a link is gone for a moment.
#pragma once

#include <chrono>
#include <optional>
#include <type_traits>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/this_coro.hpp>

#include "async/rest.hpp"
#include "gateway/axis/axis.hpp"

namespace tmcld {

/// So long a link that was lost is waited for: by all commands of one end together, from the first
/// of them that needs it.
constexpr tmcl::Duration time_for_link = std::chrono::seconds(5);
constexpr tmcl::Duration link_look_interval = std::chrono::milliseconds(50);

class ReconnectGrace {
 public:
  /// What the call gives, as soon as it is not that a link is lost; when the time is over, that.
  /// `call` begins a call that may be made more than once.
  template <class Call>
  std::invoke_result_t<Call&> insist(Call call) {
    while (true) {
      auto result = co_await call();
      const bool lost = !result && result.error().code == tmcl::Errc::link_lost;
      if (!lost) co_return result;
      const auto executor = co_await boost::asio::this_coro::executor;
      if (is_over(tmcl::now(executor))) co_return result;
      co_await rest(link_look_interval);
    }
  }

 private:
  bool is_over(tmcl::TimePoint now) {
    if (!limit_) limit_ = now + time_for_link;
    return now >= *limit_;
  }

  std::optional<tmcl::TimePoint> limit_;
};

}  // namespace tmcld
