/// A timer that goes by the clock of its execution context: in real time one of Asio's, in virtual
/// time a place in the timeline.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include <boost/asio/async_result.hpp>
#include <boost/asio/bind_allocator.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "tmcl/context_clock.hpp"
#include "tmcl/in_room.hpp"

namespace tmcl {

/// For one wait at a time. In virtual time a wait ends by cancel() only, not through a cancellation
/// slot.
class Timer {
 public:
  explicit Timer(const boost::asio::any_io_executor& executor)
      : clock_(executor), timer_(executor) {}
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;
  ~Timer() {
    if (place_) cancel();
  }

  TimePoint now() const { return clock_.now(); }
  /// Ends a wait in progress as cancel() does.
  void expires_at(TimePoint time) {
    cancel();
    if (clock_.timeline_ == nullptr) {
      timer_.expires_at(time);
    } else {
      due_ = time;
    }
  }
  void expires_after(Duration duration) { expires_at(now() + duration); }
  /// A wait in progress ends with boost::asio::error::operation_aborted.
  void cancel() {
    if (clock_.timeline_ == nullptr) {
      timer_.cancel();
    } else if (const auto place = std::exchange(place_, std::nullopt)) {
      const auto handler = clock_.timeline_->take(*place);
      if (handler) handler(boost::asio::error::operation_aborted);
    }
  }
  template <class Token>
  auto async_wait(Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code)>(
        [this](auto handler) {
          if (clock_.timeline_ == nullptr) {
            timer_.async_wait(std::move(handler));
          } else {
            place_ = clock_.timeline_->add(due_, posted(std::move(handler)));
          }
        },
        token);
  }

 private:
  /// A wait of virtual time. As with Asio's timers its end takes no memory.
  template <class Handler>
  struct Wait {
    explicit Wait(Handler its_handler) : handler(std::move(its_handler)) {}
    Handler handler;
    alignas(std::max_align_t) InRoom<void>::Room room{};
  };
  /// Ends in a turn of its own, as all that is asynchronous does.
  template <class Handler>
  detail::VirtualTimeline::Handler posted(Handler handler) {
    auto& context = static_cast<boost::asio::io_context&>(
        boost::asio::query(timer_.get_executor(), boost::asio::execution::context));
    // A std::function must be copyable, which a coroutine's handler is not.
    auto wait = std::make_shared<Wait<Handler>>(std::move(handler));
    return [&context, wait = std::move(wait)](const boost::system::error_code& error) {
      const InRoom<void> in_room(wait->room);
      auto end = [wait, error] { std::move(wait->handler)(error); };
      boost::asio::post(context.get_executor(),
                        boost::asio::bind_allocator(in_room, std::move(end)));
    };
  }

  ContextClock clock_;
  boost::asio::steady_timer timer_;
  TimePoint due_{};
  std::optional<detail::VirtualTimeline::Place> place_;
};

}  // namespace tmcl
