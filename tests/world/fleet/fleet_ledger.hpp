/// What users of a broker have asked for, set against what goes out on the wires: nothing moves
/// late, twice, by a call of another connection of the gateway, or after a stop that came later.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "world/ledger.hpp"

namespace tmcld::test {

/// One that moves something, by a value that no other one has.
struct FleetCall {
  std::string user;
  std::string method;
  std::vector<std::string> axes;
  std::int32_t value = 0;
  std::string epoch{};
  std::string nonce{};
  tmcl::TimePoint nonce_came{};
  bool is_fit = true;  ///< As the protocol wants it; others must move nothing.
  bool has_lease = false;
  bool unattended = false;
  bool is_local = false;

  tmcl::TimePoint made{};
  tmcl::TimePoint published{};  ///< The last time.
  std::optional<tmcl::TimePoint> read{};
  tmcl::TimePoint connection_began{};  ///< Of that by which it was read.
  std::string epoch_at_reading{};
  std::map<std::string, int> moved{};
};

class FleetLedger {
 public:
  /// A call is carried out so long after it was published at most: a nonce lasts for two seconds;
  /// the bridge and tmcld may each stand still for one without seeing it; and the rest is for the
  /// connection of the user to tmcld and for the bus.
  static constexpr tmcl::Duration longest_age = std::chrono::milliseconds(2'000 + 2 * 1'000 + 500);
  /// From when a stop was read until every motor has got it, where nothing stands still.
  static constexpr tmcl::Duration time_to_stop = std::chrono::milliseconds(500);

  FleetLedger(std::vector<WorldAxis> axes, std::function<tmcl::Duration()> frozen)
      : axes_(std::move(axes)), frozen_(std::move(frozen)) {}

  std::int32_t new_value() { return first_value + step_of_values * ++last_; }

  void on_made(FleetCall call, tmcl::TimePoint now) {
    call.made = now;
    call.published = now;
    note(now, call.method + " " + std::to_string(call.value) + " by " + call.user +
                  (call.is_fit ? "" : ", not fit"));
    calls_.insert_or_assign(call.value, std::move(call));
  }
  void on_published(std::int32_t value, tmcl::TimePoint now) {
    if (const auto found = calls_.find(value); found != calls_.end()) found->second.published = now;
  }
  /// The gateway has read it. The first time counts: nothing is carried out twice.
  void on_read(std::int32_t value, tmcl::TimePoint now, tmcl::TimePoint connection_began,
               const std::string& epoch) {
    const auto found = calls_.find(value);
    if (found == calls_.end()) return;
    note(now, "gateway reads " + std::to_string(value));
    found->second.read = now;
    found->second.connection_began = connection_began;
    found->second.epoch_at_reading = epoch;
  }
  /// By a call that moves nothing, and that was carried out.
  void on_nonce_used(const std::string& nonce) { nonces_used_.emplace(nonce, 0); }

  // ---- stops ----

  void on_stop_read(const std::string& correlation, tmcl::TimePoint now) {
    note(now, "gateway reads stop " + correlation);
    Stop stop{now, frozen_(), {}, correlation};
    for (const auto& axis : axes_) stop.waiting.push_back(axis.name);
    stops_.push_back(std::move(stop));
  }
  /// The gateway has said that it could not: tmcld is not there.
  void on_stop_refused(const std::string& correlation, const std::string& why,
                       tmcl::TimePoint now) {
    note(now, "stop " + correlation + " is refused: " + why);
    if (!why.starts_with("daemon_")) complain("a stop is refused: " + why);
    std::erase_if(stops_, [&](const Stop& stop) { return stop.correlation == correlation; });
  }
  void look(tmcl::TimePoint now) {
    while (!stops_.empty()) {
      const auto& stop = stops_.front();
      if (stop.waiting.empty()) {
        stops_.pop_front();
        continue;
      }
      if (now - stop.read - (frozen_() - stop.frozen) <= time_to_stop) return;
      complain("a stop that was read has not gone to " + stop.waiting.front());
      stops_.pop_front();
    }
  }

  // ---- wires ----

  void on_request(const std::string& bus, const tmcl::Request& request, tmcl::TimePoint now) {
    look(now);
    for (const auto& axis : axes_) {
      if (axis.bus != bus || axis.address.module != request.address) continue;
      if (Ledger::is_stop_of(axis, request)) note_stop(axis.name, now);
      if (Ledger::moves(request, axis.address.motor)) judge(axis.name, request, now);
    }
  }

  void complain(std::string text) {
    for (const auto& line : history_) text += "\n  " + line;
    complaints_.push_back(std::move(text));
  }
  void note(tmcl::TimePoint time, const std::string& what) {
    constexpr std::size_t most = 400;
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch());
    history_.push_back(std::to_string(us.count()) + " us: " + what);
    if (history_.size() > most) history_.pop_front();
  }
  const std::vector<std::string>& complaints() const { return complaints_; }
  std::size_t movements() const { return movements_; }
  tmcl::Duration oldest() const { return oldest_; }
  /// By what an axis turns; nothing if it does not.
  const FleetCall* turned_by(const std::string& axis) const {
    const auto found = turning_.find(axis);
    return found == turning_.end() ? nullptr : &calls_.at(found->second);
  }

 private:
  struct Stop {
    tmcl::TimePoint read;
    tmcl::Duration frozen;
    std::vector<std::string> waiting;
    std::string correlation;
  };
  static constexpr std::int32_t first_value = 1'000;
  static constexpr std::int32_t step_of_values = 3;

  void note_stop(const std::string& axis, tmcl::TimePoint now) {
    note(now, "stop of " + axis);
    turning_.erase(axis);
    for (auto& stop : stops_) {
      if (std::erase(stop.waiting, axis) == 0) continue;
      auto& read = stop_read_[axis];
      read = std::max(read, stop.read);
    }
  }

  void judge(const std::string& axis, const tmcl::Request& request, tmcl::TimePoint now) {
    ++movements_;
    turning_.erase(axis);
    const auto found = calls_.find(std::abs(request.value));
    const auto what = axis + " is moved by " + std::to_string(request.value);
    note(now, what);
    if (found == calls_.end()) return complain(what + ", and no call has asked for it");
    auto& call = found->second;
    if (std::ranges::count(call.axes, axis) == 0) complain(what + ", which was for another axis");
    if (++call.moved[axis] > 1) complain(what + ": its call is carried out twice");
    if (!call.is_local) judge_call(call, axis, what, now);
    if (call.method == "axis.rotate") turning_[axis] = call.value;
  }
  void judge_call(const FleetCall& call, const std::string& axis, const std::string& what,
                  tmcl::TimePoint now) {
    if (!call.is_fit) complain(what + ": its call is none that may move anything");
    if (!call.read) return complain(what + ": the gateway has not read its call");
    oldest_ = std::max(oldest_, now - call.published);
    if (now - call.published > longest_age)
      complain(what + ": its call was published too long ago");
    if (now - call.nonce_came > longest_age) complain(what + ": the nonce of its call is too old");
    if (nonces_used_.emplace(call.nonce, call.value).first->second != call.value)
      complain(what + ": the nonce of its call was used before");
    if (call.epoch != call.epoch_at_reading) complain(what + ": its call is of another epoch");
    if (call.made < call.connection_began)
      complain(what + ": its call is from before the connection by which it came");
    const auto stop = stop_read_.find(axis);
    if (stop != stop_read_.end() && *call.read < stop->second)
      complain(what + ": a stop that was read after its call has stopped the axis already");
    if (call.method == "axis.rotate" && !call.has_lease && !call.unattended)
      complain(what + ": without end, and without a lease");
  }

  std::vector<WorldAxis> axes_;
  std::function<tmcl::Duration()> frozen_;
  std::map<std::int32_t, FleetCall> calls_;
  std::map<std::string, std::int32_t> nonces_used_;  ///< The value of the call; 0: of another kind.
  std::map<std::string, std::int32_t> turning_;      ///< The value of the call, by axis.
  std::deque<Stop> stops_;
  /// When that stop was read which its module was sent last.
  std::map<std::string, tmcl::TimePoint> stop_read_;
  std::int32_t last_ = 0;
  std::size_t movements_ = 0;
  tmcl::Duration oldest_{};
  std::deque<std::string> history_;
  std::vector<std::string> complaints_;
};

}  // namespace tmcld::test
