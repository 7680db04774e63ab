/// What clients have asked for, set against what goes out on the wires.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <boost/json/object.hpp>

#include "api/rpc_error.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld::test {

/// A motor of the world; its axis has a name.
struct WorldAxis {
  std::string name;
  std::string bus;
  tmcl::AxisAddress address;
};

/// A call in progress.
struct WorldCall {
  std::string method;
  std::vector<std::string> axes;
  /// What the movement of each axis carries, where that is known before.
  std::vector<std::int32_t> values{};
  /// What is added to where the axis is, which is not known before.
  std::optional<std::int32_t> distance{};
};

class Ledger {
 public:
  explicit Ledger(std::vector<WorldAxis> axes) : axes_(std::move(axes)) {}

  using Number = std::uint64_t;

  /// Just before it is dispatched.
  Number begin(WorldCall call, tmcl::TimePoint now) {
    const auto number = ++last_;
    std::string names;
    for (const auto& axis : call.axes) names += " " + axis;
    note(now, "call " + std::to_string(number) + ": " + call.method + names);
    const bool stops = call.method == "axis.stop" || call.method == "system.stop_all";
    if (stops) {
      for (const auto& axis : call.axes) stops_[axis].push_back({number, now, false});
    } else {
      running_.emplace(number, Running{std::move(call), {}, {}});
    }
    return number;
  }

  void end(Number number, const RpcResult& result, tmcl::TimePoint now) {
    note(now, "end of call " + std::to_string(number) +
                  (result ? std::string() : ": " + result.error().message));
    const auto found = running_.extract(number);
    if (!found || found.mapped().call.axes.size() != 1) return;
    const auto& call = found.mapped().call;
    const auto& moved = found.mapped().moved;
    const auto sent = moved.size();
    if (result && is_movement(call) && !call.values.empty() && sent != 1)
      complain(call.method + " was done unseen");
    if (result) return;
    const auto* outcome = result.error().data.if_contains("outcome");
    if (sent > 0 && outcome != nullptr && outcome->as_string().compare("not_sent") == 0)
      complain(call.method + " was sent, but said to be not: " + result.error().message);
  }

  /// In the order in which they are on the wire.
  void on_request(const std::string& bus, const tmcl::Request& request, tmcl::TimePoint now) {
    for (const auto& axis : axes_) {
      if (axis.bus != bus || axis.address.module != request.address) continue;
      if (request.command == tmcl::Command::MST && request.motor == axis.address.motor)
        note_stop(axis.name, now);
      note_turning(axis, request);
      if (moves(request, axis.address.motor)) judge(axis.name, request, now);
    }
  }

  /// What a module answers, before anything can happen to that.
  void on_answer(const std::string& bus, const tmcl::Request& request, std::int32_t value) {
    const bool tells_position = request.command == tmcl::Command::GAP &&
                                request.type == tmcl::axis_parameter::actual_position;
    if (!tells_position) return;
    for (const auto& axis : axes_) {
      if (axis.bus != bus || axis.address != tmcl::AxisAddress{request.address, request.motor})
        continue;
      for (auto& [number, running] : running_) {
        if (std::ranges::count(running.call.axes, axis.name) != 0) running.positions.insert(value);
      }
    }
  }

  /// Axes that were told to turn, and since then neither to stop nor to go somewhere.
  std::vector<std::string> turning() const { return {turning_.begin(), turning_.end()}; }
  const std::vector<std::string>& complaints() const { return complaints_; }
  std::size_t movements() const { return movements_; }

 private:
  struct Stop {
    Number number;
    tmcl::TimePoint called;
    bool sent;
  };
  struct Running {
    WorldCall call;
    std::set<std::string> moved;         ///< Axes that a datagram has gone out to.
    std::set<std::int32_t> positions{};  ///< Where its axes were whenever that was read.
  };

  // From the manual, and not from the gateway's own table.
  static bool moves(const tmcl::Request& request, std::uint8_t motor) {
    using tmcl::Command;
    switch (request.command) {
      case Command::ROR:
      case Command::ROL: return request.motor == motor;
      case Command::MVP: {
        constexpr std::uint8_t coordinate = 2, mask = 0x3F, several = 0xC0;
        const bool names_several = request.type == coordinate && (request.motor & several) != 0;
        return names_several ? (((request.motor & mask) >> motor) & 1) != 0
                             : request.motor == motor;
      }
      case Command::SAP:
        return request.motor == motor && (request.type == tmcl::axis_parameter::target_position ||
                                          request.type == tmcl::axis_parameter::target_velocity);
      default: return false;
    }
  }

  static bool is_movement(const WorldCall& call) {
    return call.method.starts_with("axis.move") || call.method == "axis.rotate" ||
           call.method == "line.move" || call.method == "parameter.set";
  }

  void note(tmcl::TimePoint time, const std::string& what) {
    constexpr std::size_t most = 30;
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch());
    history_.push_back(std::to_string(us.count()) + " us: " + what);
    if (history_.size() > most) history_.pop_front();
  }

  void note_turning(const WorldAxis& axis, const tmcl::Request& request) {
    using tmcl::Command;
    const bool turns = request.command == Command::ROR || request.command == Command::ROL;
    if (turns && request.motor == axis.address.motor && request.value != 0) {
      turning_.insert(axis.name);
    } else if (request.command == Command::MST ? request.motor == axis.address.motor
                                               : moves(request, axis.address.motor)) {
      turning_.erase(axis.name);
    }
  }

  void note_stop(const std::string& axis, tmcl::TimePoint now) {
    note(now, "stop of " + axis);
    auto& stops = stops_[axis];
    if (!stops.empty()) stops.back().sent = true;
  }

  /// What was called before the stop must not move the axis any more. In the instant of the stop's
  /// call only the order on the wire tells what came first.
  Number stopped_before(const std::string& axis, tmcl::TimePoint now) const {
    const auto found = stops_.find(axis);
    if (found == stops_.end()) return 0;
    for (auto stop = found->second.rbegin(); stop != found->second.rend(); ++stop)
      if (stop->sent || stop->called < now) return stop->number;
    return 0;
  }

  /// Nothing where any value is right.
  static std::optional<std::int32_t> value_for(const WorldCall& call, const std::string& axis) {
    const auto place = std::ranges::find(call.axes, axis) - call.axes.begin();
    return call.values.empty() ? std::nullopt
                               : std::optional(call.values[static_cast<std::size_t>(place)]);
  }

  static bool can_have_sent(const Running& running, const std::string& axis,
                            const tmcl::Request& request) {
    const auto& [call, moved, positions] = running;
    const bool named = std::ranges::find(call.axes, axis) != call.axes.end();
    if (!is_movement(call) || !named || moved.contains(axis)) return false;
    const bool by_position = request.command == tmcl::Command::MVP;
    const bool to_coordinate = by_position && request.type == 2;
    if (to_coordinate) return call.method == "line.move";
    if (call.distance && by_position) return positions.contains(request.value - *call.distance);
    const auto value = value_for(call, axis);
    const auto sign = request.command == tmcl::Command::ROL ? -1 : 1;
    return value ? *value == sign * request.value : by_position;
  }

  void judge(const std::string& axis, const tmcl::Request& request, tmcl::TimePoint now) {
    ++movements_;
    note(now, "movement of " + axis + " with " + std::to_string(request.value));
    const auto after = stopped_before(axis, now);
    // Those whose value is known come first: others may have sent any.
    for (const bool knows : {true, false}) {
      for (auto& [number, running] : running_) {
        if (running.call.values.empty() == knows || number <= after) continue;
        if (!can_have_sent(running, axis, request)) continue;
        running.moved.insert(axis);
        return;
      }
    }
    complain("command " + std::to_string(static_cast<int>(request.command)) + " with " +
             std::to_string(request.value) + " moves " + axis + ", and no call has asked for it");
  }

  void complain(std::string text) {
    for (const auto& line : history_) text += "\n  " + line;
    complaints_.push_back(std::move(text));
  }

  std::vector<WorldAxis> axes_;
  Number last_ = 0;
  std::map<Number, Running> running_;
  std::map<std::string, std::vector<Stop>> stops_;
  std::deque<std::string> history_;  ///< What happened last, for the reader of a complaint.
  std::vector<std::string> complaints_;
  std::size_t movements_ = 0;
  std::set<std::string> turning_;
};

}  // namespace tmcld::test
