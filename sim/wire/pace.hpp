/// How long what is said takes on a wire. Off unless asked: everything is heard at once then.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "sim/module/due.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// What a module takes to answer: our choice, because no document at hand has a figure.
constexpr Duration usual_time_to_answer = std::chrono::microseconds(200);

struct Pace {
  std::uint32_t bits_per_second = 0;  ///< 0: off.
  Duration to_answer{};               ///< What a module takes to answer; only where it is not off.

  explicit operator bool() const { return bits_per_second != 0; }
  Duration of_bits(std::size_t bits) const {
    return std::chrono::nanoseconds(std::chrono::seconds(bits)) / bits_per_second;
  }
  /// With start and stop bit.
  Duration of_bytes(std::size_t count) const { return of_bits(10 * count); }
  Duration of_frame(const CanFrame& frame) const {
    return of_bits(most_bits_of_frame(frame.length, frame.extended));
  }
};

/// What is on its way along a wire: one thing after the other. Of a flood, what does not fit is
/// lost.
template <class Item>
class Transit {
 public:
  static constexpr std::size_t most_items = 1024;

  void send(Item item, TimePoint ready, Duration takes) {
    if (items_.size() >= most_items) return;
    free_at_ = std::max(free_at_, ready) + takes;
    items_.emplace_back(free_at_, std::move(item));
  }
  std::size_t size() const { return items_.size(); }
  /// What was sent last, if it is still on its way; else null.
  Item* last() { return items_.empty() ? nullptr : &items_.back().second; }
  /// When the next one has come; `never` if there is none.
  TimePoint next_due() const { return items_.empty() ? never : items_.front().first; }
  /// The next one, if it has come by now.
  std::optional<Item> take(TimePoint now) {
    if (next_due() > now || items_.empty()) return std::nullopt;
    auto item = std::move(items_.front().second);
    items_.pop_front();
    return item;
  }

 private:
  TimePoint free_at_{};
  std::deque<std::pair<TimePoint, Item>> items_;
};

}  // namespace tmcl::sim
