/// Whose axes are: who has a lease of them, or lets them turn, and which must be stopped since that
/// one is gone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tmcl/clock.hpp"

namespace tmcld::test {

class Owners {
 public:
  /// A stop goes out after the exchange in flight, and one for each axis before it. Each may be
  /// lost, and what it was about be asked for again.
  static constexpr tmcl::Duration time_to_stop = std::chrono::milliseconds(1500);

  // ---- turning ----

  void turn(const std::string& axis, std::uint64_t client, tmcl::TimePoint now) {
    turning_[axis] = client;
    if (gone_.contains(client)) owe(axis, now, Because::turning);
  }
  void end_turning(const std::string& axis) { turning_.erase(axis); }
  /// What it does now has no owner. A lease of the axis has one all the same.
  void move_by_program(const std::string& axis) {
    turning_.erase(axis);
    const auto found = owed_.find(axis);
    if (found != owed_.end() && found->second.because == Because::turning) owed_.erase(found);
  }
  /// Axes that were told to turn, and since then neither to stop nor to go somewhere.
  std::vector<std::string> turning() const {
    std::vector<std::string> axes;
    for (const auto& [axis, client] : turning_) axes.push_back(axis);
    return axes;
  }

  // ---- leases ----

  void grant(std::int64_t lease, std::uint64_t client, std::vector<std::string> axes,
             std::uint64_t last_call) {
    leases_[lease] = {client, std::move(axes), last_call, {}, {}};
  }
  /// By a call that began at `asked`: so long after that it may end already.
  void extend(std::int64_t lease, tmcl::TimePoint asked, tmcl::TimePoint now, tmcl::Duration ttl) {
    const auto found = leases_.find(lease);
    if (found == leases_.end()) return;
    found->second.may_end = asked + ttl;
    found->second.ends = now + ttl;
    if (gone_.contains(found->second.client)) lose(lease, now);
  }
  void release(std::int64_t lease) { leases_.erase(lease); }
  /// Somebody else's lease, granted before this call began, that has certainly not ended yet.
  bool is_others(const std::string& axis, std::uint64_t client, std::uint64_t call,
                 tmcl::TimePoint now) const {
    for (const auto& [number, lease] : leases_) {
      const bool holds = lease.client != client && call > lease.last_call && now < lease.may_end;
      if (holds && lease.has(axis)) return true;
    }
    return false;
  }
  std::vector<std::int64_t> leases_of(std::uint64_t client) const {
    std::vector<std::int64_t> numbers;
    for (const auto& [number, lease] : leases_)
      if (lease.client == client) numbers.push_back(number);
    return numbers;
  }

  // ---- who goes, and what must follow ----

  /// Nobody could do anything for so long.
  void on_gap(tmcl::TimePoint now, tmcl::Duration duration) {
    for (auto& [axis, owed] : owed_) owed.until += duration;
    for (auto& [number, lease] : leases_)
      if (lease.ends > now - duration) lease.ends = std::max(lease.ends, now);
  }

  void leave(std::uint64_t client, tmcl::TimePoint now) {
    gone_.emplace(client, now);
    for (const auto& [axis, owner] : turning_)
      if (owner == client) owe(axis, now, Because::turning);
    for (const auto number : leases_of(client)) lose(number, now);
  }
  bool is_gone(std::uint64_t client) const { return gone_.contains(client); }
  /// For so long that nothing that it has asked for can be waiting for its turn on a bus.
  bool is_long_gone(std::uint64_t client, tmcl::TimePoint now) const {
    const auto found = gone_.find(client);
    return found != gone_.end() && now > found->second + time_to_stop;
  }
  /// It is stopped, or its module has started again: it stands.
  void stand(const std::string& axis, tmcl::TimePoint now) {
    turning_.erase(axis);
    owed_.erase(axis);
    stood_[axis] = now;
  }
  /// Axes that should have been stopped by now. Each is told once.
  std::vector<std::string> overdue(tmcl::TimePoint now) {
    std::map<std::int64_t, tmcl::TimePoint> ended;
    for (const auto& [number, lease] : leases_)
      if (lease.ends < now) ended.emplace(number, lease.ends);
    for (const auto& [number, end] : ended) lose(number, end);
    std::vector<std::string> axes;
    for (const auto& [axis, owed] : owed_)
      if (owed.until < now) axes.push_back(axis);
    for (const auto& axis : axes) owed_.erase(axis);
    return axes;
  }

 private:
  struct Lease {
    std::uint64_t client;
    std::vector<std::string> axes;
    std::uint64_t last_call;
    tmcl::TimePoint may_end;
    tmcl::TimePoint ends;
    bool has(const std::string& axis) const { return std::ranges::find(axes, axis) != axes.end(); }
  };

  enum class Because : std::uint8_t { turning, lease };
  struct Owed {
    tmcl::TimePoint until;
    Because because;
  };

  void owe(const std::string& axis, tmcl::TimePoint since, Because because) {
    const auto [owed, is_new] = owed_.try_emplace(axis, Owed{since + time_to_stop, because});
    if (!is_new && because == Because::lease) owed->second.because = because;
  }
  /// It may have ended before, and its axes have been stopped already.
  void lose(std::int64_t number, tmcl::TimePoint since) {
    const auto& lease = leases_[number];
    for (const auto& axis : lease.axes)
      if (!stood_.contains(axis) || stood_[axis] < lease.may_end) owe(axis, since, Because::lease);
    leases_.erase(number);
  }

  std::map<std::string, std::uint64_t> turning_;
  std::map<std::int64_t, Lease> leases_;
  std::map<std::uint64_t, tmcl::TimePoint> gone_;
  std::map<std::string, Owed> owed_;
  std::map<std::string, tmcl::TimePoint> stood_;
};

}  // namespace tmcld::test
