/// The clock of everything that runs on one execution context of Boost.Asio: the computer's, or a
/// virtual one if the context has a VirtualTime. Timers of the context (tmcl/timer.hpp) go by it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/execution/context.hpp>
#include <boost/asio/execution_context.hpp>
#include <boost/asio/query.hpp>
#include <boost/system/error_code.hpp>

#include "tmcl/clock.hpp"

namespace tmcl {

namespace detail {

/// The virtual time of a context, and who waits for it. Equal times end in the order in which they
/// were set.
class VirtualTimeline final : public boost::asio::execution_context::service {
 public:
  using key_type = VirtualTimeline;
  static inline boost::asio::execution_context::id id;

  using Handler = std::function<void(const boost::system::error_code&)>;
  using Place = std::pair<TimePoint, std::uint64_t>;

  explicit VirtualTimeline(boost::asio::execution_context& context) : service(context) {}

  Place add(TimePoint due, Handler handler) {
    const Place place{due, ++last_};
    waiting_.emplace(place, std::move(handler));
    return place;
  }
  /// Empty if it has ended.
  Handler take(Place place) {
    auto found = waiting_.extract(place);
    return found ? std::move(found.mapped()) : Handler{};
  }
  /// TimePoint::max() means no deadline: such waits do not count as due.
  std::optional<Place> earliest() const {
    const bool none = waiting_.empty() || waiting_.begin()->first.first == TimePoint::max();
    return none ? std::nullopt : std::optional(waiting_.begin()->first);
  }

  VirtualClock clock;
  std::function<Duration()> time_for_work;

 private:
  // Handlers hold the frames of coroutines, in which there are timers that leave this place.
  void shutdown() override { std::exchange(waiting_, {}).clear(); }

  std::uint64_t last_ = 0;
  std::map<Place, Handler> waiting_;
};

}  // namespace detail

class ContextClock final : public Clock {
 public:
  explicit ContextClock(boost::asio::execution_context& context) {
    using detail::VirtualTimeline;
    if (boost::asio::has_service<VirtualTimeline>(context))
      timeline_ = &boost::asio::use_service<VirtualTimeline>(context);
  }
  explicit ContextClock(const boost::asio::any_io_executor& executor)
      : ContextClock(boost::asio::query(executor, boost::asio::execution::context)) {}

  TimePoint now() const override {
    return timeline_ != nullptr ? timeline_->clock.now() : RealClock().now();
  }
  /// What the time of day was at an instant, as it is now thought to be; virtual time begins at 0.
  UtcTime utc_of(TimePoint instant) const {
    if (timeline_ != nullptr) return UtcTime(instant.time_since_epoch());
    return RealClock::utc() + (instant - now());
  }
  /// In virtual time: how long work takes that a program does on another thread otherwise, and that
  /// is to be done on the thread of the context then. Nothing in real time.
  std::optional<Duration> time_for_work() const {
    if (timeline_ == nullptr) return std::nullopt;
    return timeline_->time_for_work ? timeline_->time_for_work() : Duration{};
  }

 private:
  friend class Timer;
  detail::VirtualTimeline* timeline_ = nullptr;
};

inline TimePoint now(const boost::asio::any_io_executor& executor) {
  return ContextClock(executor).now();
}

}  // namespace tmcl
