/// Runs a whole world of programs in one process on virtual time: nothing waits, an hour takes as
/// long as what is done in it, and it comes out the same every time.
///
///     boost::asio::io_context context;
///     tmcl::VirtualTime time(context);  // before anything that takes its time from the context
///     tmcl::Bus bus(context.get_executor(), std::move(link));
///     ...
///     time.run_for(std::chrono::hours(1));
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <boost/asio/io_context.hpp>

#include "tmcl/context_clock.hpp"

namespace tmcl {

/// The context is run by this alone. Timers of other kinds, such as Asio's own, go by the
/// computer's clock and are not waited for.
class VirtualTime {
 public:
  explicit VirtualTime(boost::asio::io_context& context)
      : VirtualTime(context, boost::asio::use_service<detail::VirtualTimeline>(
                                 static_cast<boost::asio::execution_context&>(context))) {
    // Far from zero: time points of zero mean "never" to some.
    timeline_->clock.advance_to(TimePoint(std::chrono::hours(1)));
  }

  /// None if the context is on the computer's time.
  static std::optional<VirtualTime> of(boost::asio::io_context& context) {
    if (!boost::asio::has_service<detail::VirtualTimeline>(context)) return std::nullopt;
    return VirtualTime(context, boost::asio::use_service<detail::VirtualTimeline>(
                                    static_cast<boost::asio::execution_context&>(context)));
  }

  TimePoint now() const { return timeline_->clock.now(); }
  /// How long work takes that programs do on other threads; no time by default.
  void set_time_for_work(std::function<Duration()> time) {
    timeline_->time_for_work = std::move(time);
  }

  /// When the earliest timer ends; none if there is no timer.
  std::optional<TimePoint> next_due() const {
    const auto next = timeline_->earliest();
    return next ? std::optional(next->first) : std::nullopt;
  }

  /// Does all that can be done now.
  void settle() {
    context_->restart();
    context_->poll();  // ends when a look at the descriptors has found nothing more
  }
  /// Does all that can be done now, goes to the earliest timer that ends by `limit`, and does what
  /// comes of that. False if there is none: the time stays as it is.
  bool step(TimePoint limit = TimePoint::max()) {
    settle();
    return go_on(limit);
  }
  void run_until(TimePoint limit) {
    settle();
    while (go_on(limit)) {
    }
    if (limit > now()) timeline_->clock.advance_to(limit);
  }
  /// Nothing is done meanwhile, as in a process that is stopped.
  void freeze_for(Duration duration) { timeline_->clock.advance_to(now() + duration); }
  void run_for(Duration duration) { run_until(now() + duration); }
  /// Runs until the condition holds; false if it does not within this time, or never can.
  template <class Condition>
  bool run_while_not(Condition condition, Duration at_most) {
    const auto limit = now() + at_most;
    settle();
    while (!condition()) {
      if (!go_on(limit)) return false;
    }
    return true;
  }

 private:
  VirtualTime(boost::asio::io_context& context, detail::VirtualTimeline& timeline)
      : context_(&context), timeline_(&timeline) {}

  bool go_on(TimePoint limit) {
    const auto next = timeline_->earliest();
    if (!next || next->first > limit) return false;
    if (next->first > now()) timeline_->clock.advance_to(next->first);
    const auto handler = timeline_->take(*next);
    handler({});
    settle();
    return true;
  }

  boost::asio::io_context* context_;
  detail::VirtualTimeline* timeline_;
};

}  // namespace tmcl
