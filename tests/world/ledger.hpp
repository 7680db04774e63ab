/// What clients have asked for, set against what goes out on the wires.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>

#include "api/error.hpp"
#include "gateway/module/sentinel.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"
#include "world/owners.hpp"
#include "world/programs.hpp"
#include "world/restarts.hpp"

namespace tmcld::test {

/// A motor of the world; its axis has a name.
struct WorldAxis {
  std::string name;
  std::string bus;
  tmcl::AxisAddress address;
  /// It does not go farther than this from 0; 0: nobody minds.
  std::int32_t soft_limit = 0;
};

/// A call in progress.
struct WorldCall {
  /// The method of what a host at a port asks for.
  static constexpr auto at_port = "a command at a port";

  std::string method;
  std::vector<std::string> axes;
  /// What the movement of each axis carries, where that is known before: of a Mint program first
  /// those of the first movement, then those of the next.
  std::vector<std::int32_t> values{};
  /// What is added to where the axis is, which is not known before.
  std::optional<std::int32_t> distance{};
  /// Who has made it.
  std::uint64_t client = 0;
  /// The parameter that it reads, or the lease that it is about.
  std::int64_t about = 0;
  /// What it is to send.
  std::optional<tmcl::Request> raw{};
  /// Where to is in its module.
  std::optional<std::uint8_t> coordinate{};
  /// What runs a program in their module, or a line of it.
  std::optional<tmcl::Request> program{};
  /// What it writes into the memory of their module.
  tmcl::program::Program lines{};

  /// It leads its axes, and belongs to the gateway.
  bool leads() const { return method == "line.move" || method == "mint.run"; }
  std::size_t movements_of_each() const {
    return method == "mint.run" ? values.size() / axes.size() : 1;
  }
  bool stops() const {
    return method == "axis.stop" || method == "system.stop_all" ||
           (raw && raw->command == tmcl::Command::MST);
  }
};

class Ledger {
 public:
  /// Where a value may be another one's, as nothing moves by it, they are not looked at.
  Ledger(std::vector<WorldAxis> axes, bool values_are_right)
      : axes_(std::move(axes)), values_are_right_(values_are_right) {}

  using Number = std::uint64_t;

  /// How often a program in its module has moved the motor of an axis.
  std::function<std::int32_t(const WorldAxis&)> moves_by_program{};

  /// Just before it is dispatched.
  Number begin(WorldCall call, tmcl::TimePoint now) {
    const auto number = ++last_;
    std::string names;
    for (const auto& axis : call.axes) names += " " + axis;
    for (const auto value : call.values) names += " " + std::to_string(value);
    if (call.distance) names += " by " + std::to_string(*call.distance);
    names += ", by client " + std::to_string(call.client);
    note(now, "call " + std::to_string(number) + ": " + call.method + names);
    if (call.method == "axis.recover") restarts_.allow(call.axes.front(), number);
    if (call.method == "lease.release") owners_.release(call.about);
    if (call.stops()) {
      for (const auto& axis : call.axes) stops_[axis].push_back({number, now, false});
      if (call.axes.size() == 1) stopping_.emplace(number, Stopping{call.axes.front(), now});
    } else {
      running_.emplace(number, Running{std::move(call), now});
    }
    return number;
  }

  void end(Number number, const Result<boost::json::object>& result, tmcl::TimePoint now) {
    note(now, "end of call " + std::to_string(number) +
                  (result ? std::string() : ": " + result.error().message));
    if (const auto stopped = stopping_.extract(number)) look_at_stop(stopped.mapped(), result);
    const auto found = running_.extract(number);
    if (!found) return;
    const auto& running = found.mapped();
    const auto& call = running.call;
    // Of a restart since the call it knows nothing.
    if (call.method == "axis.recover" && !result) restarts_.withdraw(call.axes.front(), number);
    if (result) {
      note_lease(running, *result, now);
      if (values_are_right_ && !has_restarted(running)) look_at_values(running, *result);
      // A datagram has no place for it.
      if (call.program && call.method != WorldCall::at_port) look_whether_unattended(call, *result);
    }
    look_at_outcome(running, result);
  }

  /// A client has lost its connection.
  void on_leave(std::uint64_t client, tmcl::TimePoint now) {
    note(now, "client " + std::to_string(client) + " goes");
    look_at_programs();
    owners_.leave(client, now);
  }
  std::vector<std::int64_t> leases_of(std::uint64_t client) const {
    return owners_.leases_of(client);
  }

  /// What has to have happened by now.
  void look(tmcl::TimePoint now) {
    for (const auto& axis : owners_.overdue(now))
      complain(axis + " was not stopped, although its owner is gone");
  }
  /// Where the motor of an axis really is.
  void on_place(const std::string& name, std::int64_t place) {
    const auto axis = std::ranges::find(axes_, name, &WorldAxis::name);
    if (axis->soft_limit != 0 && std::abs(place) > axis->soft_limit)
      complain(name + " is at " + std::to_string(place) + ", beyond its soft limit");
  }

  /// The gateway stood still for so long, until now: what was asked for before is stale.
  void on_gap(tmcl::TimePoint now, tmcl::Duration duration) {
    look(now - duration);
    note(now, "end of a gap");
    last_stale_ = last_;
    owners_.on_gap(now, duration);
  }

  /// The supply of a module has failed, and is back. Of one that nobody watches nobody knows it.
  void on_restart(const std::string& bus, tmcl::ModuleAddress module, tmcl::TimePoint now,
                  const std::string& watched_by) {
    for (const auto& axis : axes_) {
      if (axis.bus != bus || axis.address.module != module) continue;
      note(now, "module of " + axis.name + " starts again, watched by " + watched_by);
      restarts_.note(axis.name, now, watched_by);
      owners_.stand(axis.name, now);
    }
  }

  /// Its module has got no command for too long, and has stopped it.
  void on_deadman(const std::string& axis, tmcl::TimePoint now) { owners_.stand(axis, now); }

  /// In the order in which they are on the wire. `is_recorded`: its module loads a program.
  void on_request(const std::string& bus, const tmcl::Request& request, tmcl::TimePoint now,
                  bool is_recorded) {
    look_at_programs();
    look(now);
    if (is_line(bus, request, now, is_recorded)) return;
    for (const auto& axis : axes_) {
      if (axis.bus != bus || axis.address.module != request.address) continue;
      if (is_stop_of(axis, request)) note_stop(axis.name, now);
      if (is_stop_of(axis, request)) of_programs_.erase(axis.name);
      if (!moves(request, axis.address.motor)) continue;
      if (!starts_program(request)) of_programs_.erase(axis.name);
      const auto client = judge(axis.name, request, now);
      note_turning(axis, request, client, now);
      look_at_limits(axis, request);
    }
  }

  /// What a module answers, before anything can happen to that.
  void on_answer(const std::string& bus, const tmcl::Request& request, std::int32_t value,
                 tmcl::TimePoint now) {
    const bool reads = request.command == tmcl::Command::GAP;
    for (const auto& axis : axes_) {
      if (axis.bus != bus || axis.address.module != request.address) continue;
      if (is_stop_of(axis, request)) stopped_[axis.name] = now;
      for (auto& [number, running] : running_) {
        if (std::ranges::count(running.call.axes, axis.name) == 0) continue;
        if (reads && request.motor == axis.address.motor)
          running.readings.insert({request.type, value});
        if (running.sent == request) running.executed = true;
      }
    }
  }

  /// What somebody else has noticed.
  void complain(std::string text) {
    for (const auto& line : history_) text += "\n  " + line;
    complaints_.push_back(std::move(text));
  }

  /// Axes that were told to turn, and since then neither to stop nor to go somewhere.
  std::vector<std::string> turning() const { return owners_.turning(); }
  const std::vector<std::string>& complaints() const { return complaints_; }
  std::size_t movements() const { return movements_; }
  /// Since then nothing else has moved it, or stopped it.
  bool was_moved_by_program(const std::string& axis) {
    look_at_programs();
    return of_programs_.contains(axis);
  }

  // From the manual, and not from the gateway's own table.
  static bool moves(const tmcl::Request& request, std::uint8_t motor) {
    using tmcl::Command;
    switch (request.command) {
      case Command::ROR:
      case Command::ROL: return request.motor == motor;
      case Command::RFS: return request.type == start_search && request.motor == motor;
      case Command::MVP: {
        constexpr std::uint8_t coordinate = 2, mask = 0x3F, several = 0xC0;
        const bool names_several = request.type == coordinate && (request.motor & several) != 0;
        return names_several ? (((request.motor & mask) >> motor) & 1) != 0
                             : request.motor == motor;
      }
      case Command::SAP:
        return request.motor == motor && (request.type == tmcl::axis_parameter::target_position ||
                                          request.type == tmcl::axis_parameter::target_velocity);
      default: return starts_program(request);
    }
  }
  static bool is_stop_of(const WorldAxis& axis, const tmcl::Request& request) {
    return request.command == tmcl::Command::MST && request.motor == axis.address.motor;
  }

 private:
  struct Stopping {
    std::string axis;
    tmcl::TimePoint began;
  };
  struct Stop {
    Number number;
    tmcl::TimePoint called;
    bool sent;
  };
  struct Running {
    WorldCall call;
    tmcl::TimePoint began;
    std::map<std::string, std::size_t> moved{};  ///< Axes, and how many datagrams moved them.
    /// What was read of its axes: parameters, and what they really were.
    std::set<std::pair<std::uint8_t, std::int32_t>> readings{};
    std::optional<tmcl::Request> sent{};  ///< The last that moves something.
    bool executed = false;
  };

  static constexpr std::uint8_t start_search = 0;
  static constexpr std::int32_t coordinate_of_lines = 0;  // clients have others

  static bool is_movement(const WorldCall& call) {
    return call.method.starts_with("axis.move") || call.method == "axis.rotate" ||
           call.method == "axis.home" || call.method == "line.move" ||
           call.method == "parameter.set" || call.method == "mint.run" || call.coordinate ||
           call.program || (call.raw && moves(*call.raw, call.raw->motor));
  }

  void note(tmcl::TimePoint time, const std::string& what) {
    constexpr std::size_t most = 30;
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch());
    history_.push_back(std::to_string(us.count()) + " us: " + what);
    if (history_.size() > most) history_.pop_front();
  }

  void note_turning(const WorldAxis& axis, const tmcl::Request& request, std::uint64_t client,
                    tmcl::TimePoint now) {
    using tmcl::Command;
    // What the program does, it counts.
    if (starts_program(request)) return;
    const bool turns = request.command == Command::ROR || request.command == Command::ROL;
    if (turns && request.value != 0) {
      // Who does not hear it does not turn.
      if (!restarts_.is_deaf(axis.name, now)) owners_.turn(axis.name, client, now);
    } else {
      owners_.end_turning(axis.name);
    }
  }

  void note_stop(const std::string& axis, tmcl::TimePoint now) {
    note(now, "stop of " + axis);
    owners_.stand(axis, now);
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
  static std::optional<std::int32_t> value_for(const Running& running, const std::string& axis) {
    const auto& call = running.call;
    const auto place = std::ranges::find(call.axes, axis) - call.axes.begin();
    const auto before = times_moved(running, axis) * call.axes.size();
    return call.values.empty()
               ? std::nullopt
               : std::optional(call.values[before + static_cast<std::size_t>(place)]);
  }
  static std::size_t times_moved(const Running& running, const std::string& axis) {
    const auto found = running.moved.find(axis);
    return found == running.moved.end() ? 0 : found->second;
  }

  /// A line starts all its axes of one module with one datagram.
  bool starts_all_of_module(const WorldCall& call, const tmcl::Request& request,
                            const std::string& axis) const {
    const auto one = std::ranges::find(axes_, axis, &WorldAxis::name);
    return std::ranges::all_of(axes_, [&](const WorldAxis& other) {
      const bool beside = other.bus == one->bus && other.address.module == one->address.module;
      const bool named = std::ranges::find(call.axes, other.name) != call.axes.end();
      return !beside || named == moves(request, other.address.motor);
    });
  }

  /// Its coordinates are read, and sent as positions.
  bool has_limit(const std::string& axis) const {
    return std::ranges::find(axes_, axis, &WorldAxis::name)->soft_limit != 0;
  }

  bool can_have_sent(const Running& running, const std::string& axis,
                     const tmcl::Request& request) const {
    const auto& call = running.call;
    const bool named = std::ranges::find(call.axes, axis) != call.axes.end();
    if (!is_movement(call) || !named) return false;
    if (times_moved(running, axis) >= call.movements_of_each()) return false;
    if (call.program || starts_program(request)) return call.program == request;
    const bool searches = request.command == tmcl::Command::RFS;
    if (searches || call.method == "axis.home") return searches && call.method == "axis.home";
    const bool by_position = request.command == tmcl::Command::MVP;
    const bool to_coordinate = by_position && request.type == 2;
    if (call.coordinate && !to_coordinate) return by_position && has_limit(axis);
    if (call.coordinate) return *call.coordinate == request.value;
    if (to_coordinate)
      return call.leads() && request.value == coordinate_of_lines &&
             starts_all_of_module(call, request, axis);
    if (call.distance && by_position)
      return running.readings.contains(
          {tmcl::axis_parameter::actual_position, request.value - *call.distance});
    const auto value = value_for(running, axis);
    const auto sign = request.command == tmcl::Command::ROL ? -1 : 1;
    // Of a setting that moves nothing no value is known.
    const bool goes_anywhere = by_position && call.method != "parameter.set";
    return value ? *value == sign * request.value : goes_anywhere;
  }

  /// The call that has sent it, of those that may have. Those whose value is known come first:
  /// others may have sent any. Of several that ask for the same it is not known which was sent: one
  /// that may move the axis, whose client is still there.
  std::optional<Number> sender_of(const std::string& axis, const tmcl::Request& request,
                                  Number after, tmcl::TimePoint now) const {
    using Doubts = std::tuple<bool, bool, bool, Number>;
    std::optional<Doubts> least;
    for (const auto& [number, running] : running_) {
      if (number <= after || !can_have_sent(running, axis, request)) continue;
      const auto& call = running.call;
      const Doubts doubts{call.values.empty(), owners_.is_others(axis, call.client, number, now),
                          owners_.is_gone(call.client), number};
      if (!least || doubts < *least) least = doubts;
    }
    return least ? std::optional(std::get<Number>(*least)) : std::nullopt;
  }

  /// The client that has asked for it, or 0.
  std::uint64_t judge(const std::string& axis, const tmcl::Request& request, tmcl::TimePoint now) {
    ++movements_;
    note(now, "movement of " + axis + " with " + std::to_string(request.value));
    const auto after = std::max(stopped_before(axis, now), last_stale_);
    if (const auto number = sender_of(axis, request, after, now)) {
      auto& running = running_.at(*number);
      ++running.moved[axis];
      running.sent = request;
      if (request.command == tmcl::Command::RFS) restarts_.allow(axis, *number);
      look_for_latch(axis, running.call, now);
      look_for_owner(axis, running.call, *number, now);
      return running.call.client;
    }
    complain("command " + std::to_string(static_cast<int>(request.command)) + " with " +
             std::to_string(request.value) + " moves " + axis + ", and no call has asked for it" +
             (stopped_before(axis, now) > 0 ? " since its stop" : ""));
    return 0;
  }

  void look_for_latch(const std::string& axis, const WorldCall& by, tmcl::TimePoint now) {
    // Of lines is assumed that modules take longer to start.
    const bool may_be_unseen = by.leads() && now - restarts_.last(axis) <= journey_sentinel_age;
    if (may_be_unseen) restarts_.hide(axis);
    if (restarts_.is_latched(axis) && !restarts_.is_deaf(axis, now) && !may_be_unseen)
      complain(axis +
               " is moved, although its module has started again, and nobody has said since "
               "that it may move");
  }

  void look_for_owner(const std::string& axis, const WorldCall& by, Number number,
                      tmcl::TimePoint now) {
    if (owners_.is_others(axis, by.client, number, now))
      complain(by.method + " moves " + axis + ", of which somebody else has a lease");
    if (!by.leads() && owners_.is_long_gone(by.client, now))
      complain(by.method + " moves " + axis + ", and who has asked for it is gone");
  }

  void look_at_limits(const WorldAxis& axis, const tmcl::Request& request) {
    using tmcl::Command;
    const bool turns = request.command == Command::ROR || request.command == Command::ROL;
    const bool is_beyond = turns ? request.value != 0 : std::abs(request.value) > axis.soft_limit;
    if (axis.soft_limit != 0 && is_beyond)
      complain(axis.name + " is sent beyond its soft limit: " + std::to_string(request.value));
  }

  void note_lease(const Running& running, const boost::json::object& result, tmcl::TimePoint now) {
    const auto& call = running.call;
    const bool acquires = call.method == "lease.acquire";
    if (!acquires && call.method != "lease.renew") return;
    const auto number = result.at("lease").as_int64();
    const std::chrono::milliseconds ttl(result.at("ttl_ms").as_int64());
    if (acquires) owners_.grant(number, call.client, call.axes, last_);
    owners_.extend(number, running.began, now, ttl);
  }

  /// Of what was on its way when its module started again, nobody can tell what it answered.
  bool has_restarted(const Running& running) const {
    return std::ranges::any_of(
        running.call.axes, [&](const auto& axis) { return restarts_.last(axis) >= running.began; });
  }

  /// Whether each value is one that the module has really told, in answer to that question.
  void look_at_values(const Running& running, const boost::json::object& result) {
    const auto is_true = [&](std::uint8_t parameter, const boost::json::value& value) {
      return running.readings.contains({parameter, static_cast<std::int32_t>(value.as_int64())});
    };
    namespace ap = tmcl::axis_parameter;
    const auto& method = running.call.method;
    if (method == "parameter.get") {
      if (!is_true(static_cast<std::uint8_t>(running.call.about), result.at("value")))
        complain("parameter.get told what the module did not");
    } else if (method == "axis.get_state") {
      if (!is_true(ap::actual_position, result.at("position_microsteps")) ||
          !is_true(ap::actual_velocity, result.at("velocity_internal")))
        complain("axis.get_state told what the module did not");
    }
  }

  /// What a program moves has no owner, and who has run it is told so.
  void look_whether_unattended(const WorldCall& call, const boost::json::object& result) {
    const auto* warnings = call.raw ? result.if_contains("warnings") : nullptr;
    const bool is_told = call.raw ? warnings != nullptr && boost::json::serialize(*warnings).find(
                                                               "unattended") != std::string::npos
                                  : result.at("unattended") == true;
    if (!is_told) complain(call.method + " did not tell that what it moves is unattended");
  }

  void look_at_stop(const Stopping& stopping, const Result<boost::json::object>& result) {
    const auto found = stopped_.find(stopping.axis);
    const bool is_done = found != stopped_.end() && found->second >= stopping.began;
    const bool has_restarted = restarts_.last(stopping.axis) >= stopping.began;
    if (result && values_are_right_ && !is_done && !has_restarted)
      complain("a stop of " + stopping.axis + " was done, but its module has not executed it");
  }

  /// A program that has moved a motor has taken it from who let it turn.
  void look_at_programs() {
    if (!moves_by_program) return;
    for (const auto& axis : axes_) {
      const auto count = moves_by_program(axis);
      if (std::exchange(programs_moved_[axis.name], count) == count) continue;
      owners_.move_by_program(axis.name);
      of_programs_.insert(axis.name);
    }
  }

  /// It is loaded into the memory of the module, or would be if that heard it.
  bool is_line(const std::string& bus, const tmcl::Request& request, tmcl::TimePoint now,
               bool is_recorded) {
    const auto axis = std::ranges::find_if(axes_, [&](const WorldAxis& one) {
      return one.bus == bus && one.address.module == request.address;
    });
    if (axis == axes_.end()) return false;
    const bool is_of_load = std::ranges::any_of(running_, [&](const auto& one) {
      const auto& call = one.second.call;
      return std::ranges::count(call.axes, axis->name) > 0 &&
             std::ranges::count(call.lines, line_of(request)) > 0;
    });
    if (is_of_load) return is_recorded || restarts_.is_deaf(axis->name, now);
    if (is_recorded && (moves(request, request.motor) || is_stop_of(*axis, request)))
      complain("a command for " + axis->name + " is recorded in a program that it is no line of");
    return is_recorded;
  }

  void look_at_outcome(const Running& running, const Result<boost::json::object>& result) {
    const auto& call = running.call;
    if (call.axes.size() != 1) return;
    const bool moves = is_movement(call) && (!call.values.empty() || call.distance || call.program);
    if (result && moves && running.moved.empty()) complain(call.method + " was done unseen");
    if (result && moves && !running.executed && !has_restarted(running))
      complain(call.method + " was done, but its module has not executed it");
    if (result) return;
    if (!running.moved.empty() && result.error().outcome == tmcl::Outcome::not_sent)
      complain(call.method + " was sent, but said to be not: " + result.error().message);
  }

  std::vector<WorldAxis> axes_;
  bool values_are_right_;
  Number last_ = 0;
  Number last_stale_ = 0;
  std::map<Number, Running> running_;
  std::map<std::string, std::vector<Stop>> stops_;
  std::map<Number, Stopping> stopping_;                   ///< Calls, each for one axis.
  std::map<std::string, tmcl::TimePoint> stopped_;        ///< When modules executed a stop last.
  std::map<std::string, std::int32_t> programs_moved_{};  ///< How often.
  std::set<std::string> of_programs_;                     ///< Axes that a program has moved last.
  std::deque<std::string> history_;  ///< What happened last, for the reader of a complaint.
  std::vector<std::string> complaints_;
  std::size_t movements_ = 0;
  Owners owners_;
  Restarts restarts_;
};

}  // namespace tmcld::test
