/// Whether the reactor has stood still: its process was stopped, had more to do than it could, or
/// the computer slept.
/// What was asked for before the end of such a gap is stale: it may not be wanted any
/// more, so it moves nothing.
///
/// While it stands still calls come in that it sees only after that. So a gap lasts for some time
/// longer, in which these are taken in.
///
///     turning ──longest_gap without a look──▶ in a gap ──end()──▶ turning
///
/// Does no I/O, reads no clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "tmcl/clock.hpp"

namespace tmcld {

class Gaps {
 public:
  static constexpr tmcl::Duration longest_gap = std::chrono::seconds(1);
  /// How often look() must be called.
  static constexpr tmcl::Duration look_interval = std::chrono::milliseconds(200);
  static constexpr tmcl::Duration time_to_take_in = std::chrono::milliseconds(20);

  /// The reactor turns. `slept`: how long the computer has slept until now, which is no part of
  /// the time that `now` counts.
  void look(tmcl::TimePoint now, tmcl::Duration slept) {
    const bool is_first = looked_ == tmcl::TimePoint{};
    const auto passed = (now - looked_) + (slept - slept_);
    looked_ = now;
    slept_ = slept;
    if (is_first || passed <= longest_gap) return;
    is_in_gap_ = true;
    duration_ = passed;
    ended_ = now;
  }
  bool is_in_gap() const { return is_in_gap_; }
  /// What came in meanwhile has been taken in: calls up to this number.
  void end(std::uint64_t last_call) {
    is_in_gap_ = false;
    last_stale_ = last_call;
  }

  /// The last call that is stale.
  std::uint64_t last_stale() const {
    return is_in_gap_ ? std::numeric_limits<std::uint64_t>::max() : last_stale_;
  }
  /// When it was looked last; TimePoint{}: never.
  tmcl::TimePoint looked() const { return looked_; }
  /// Of a call whose sender has said when.
  bool is_stale(tmcl::TimePoint sent) const { return sent < ended_; }
  /// When the last one was over; TimePoint{}: there was none.
  tmcl::TimePoint ended() const { return ended_; }
  /// How long the last one was.
  tmcl::Duration duration() const { return duration_; }

 private:
  tmcl::TimePoint looked_{};
  tmcl::Duration slept_{};
  tmcl::TimePoint ended_{};
  tmcl::Duration duration_{};
  bool is_in_gap_ = false;
  std::uint64_t last_stale_ = 0;
};

/// For the client of a stale request.
std::string stale_text(const Gaps& gaps);
std::string gap_text(const Gaps& gaps);
constexpr std::string_view stale_hint = "ask again if it is still wanted";

}  // namespace tmcld
