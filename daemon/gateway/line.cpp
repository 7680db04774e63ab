#include "gateway/line.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <ranges>
#include <utility>

#include <fmt/format.h>

#include "async/gather.hpp"
#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "gateway/link_patience.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using std::chrono::milliseconds;
using tmcl::Duration;
using tmcl::Microsteps;
using tmcl::plan::Setting;
using Fault = std::optional<LineFailure>;

namespace ap = tmcl::axis_parameter;

constexpr Duration look_interval = milliseconds(20);
// A motor may stand for so long at the beginning; a reading may be older than the start.
constexpr Duration time_to_begin = milliseconds(200);
constexpr Duration tolerated_delay = std::chrono::seconds(2);
constexpr Duration time_to_stand = std::chrono::seconds(10);
// Coordinate 0 is never kept in the EEPROM.
constexpr std::uint8_t scratch_coordinate = 0;

tmcl::Error broken(std::string message, std::string hint = {}) {
  tmcl::Error error;
  error.code = tmcl::Errc::move_interrupted;
  error.outcome = tmcl::Outcome::done;
  error.message = std::move(message);
  error.hint = std::move(hint);
  return error;
}

/// How long the exchanges of a line have taken on one bus.
class Traffic {
 public:
  void note(Duration exchange) { exchanges_.push_back(exchange); }
  /// The median: a busy moment makes no difference.
  Duration exchange() const {
    if (exchanges_.empty()) return {};
    auto sorted = exchanges_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    return *middle;
  }

 private:
  std::vector<Duration> exchanges_;
};

/// What one axis has to do with the line.
struct Member : LineMember {
  RunOptions movement{};
  std::optional<tmcl::plan::AxisTwin> twin{};
  std::vector<Setting> before{};   // its ramp's settings
  std::vector<Setting> changed{};  // those that the line has changed, as they were
  bool arrived = false;
  int stood = 0;                           // how many looks
  std::optional<tmcl::Error> unstopped{};  // why it could not be stopped

  LineFailure failure(tmcl::Error error) const { return {std::move(error), axis->name()}; }
};

class LineRun : public std::enable_shared_from_this<LineRun> {
 public:
  explicit LineRun(LineOrder order)
      : permit_(order.permit), duration_(order.duration), planner_(order.planner) {
    for (auto& member : order.members) {
      auto movement = member.axis->begin_movement(permit_, order.deadline);
      auto& traffic = traffic_[member.axis->bus().name()];
      movement.on_answer = [&traffic](Duration exchange) { traffic.note(exchange); };
      members_.push_back({std::move(member), std::move(movement)});
    }
  }

  awaitable<tl::expected<StartedLine, LineFailure>> start() {
    if (auto fault = co_await take_axes()) co_return tl::unexpected(std::move(*fault));
    Fault fault;
    std::exception_ptr failure;
    try {
      fault = co_await prepare_and_go();
    } catch (...) {
      failure = std::current_exception();
    }
    if (fault || failure) {
      if (started_) {
        co_await stop_all();
        if (fault) add_unstopped(fault->error);
        co_await wait_for_standstill();
      }
      co_await end();
      if (failure) std::rethrow_exception(failure);
      co_return tl::unexpected(std::move(*fault));
    }
    const auto executor = co_await boost::asio::this_coro::executor;
    spawn(executor, guard(shared_from_this()));
    co_return line_;
  }

 private:
  tmcl::TimePoint now() const { return members_.front().axis->bus().clock().now(); }

  awaitable<Fault> take_axes() {
    std::vector<std::shared_ptr<GatewayAxis>> axes;
    for (const auto& member : members_) axes.push_back(member.axis);
    auto taken = co_await claim_all(std::move(axes), Mover::line, permit_);
    co_return taken;
  }

  awaitable<Fault> prepare_and_go() {
    auto fault = co_await look();
    if (!fault) fault = co_await plan();
    if (!fault) fault = co_await load();
    if (!fault) fault = co_await go();
    co_return fault;
  }

  awaitable<Fault> look() {
    for (auto& member : members_) {
      auto ready = co_await member.axis->be_ready();
      if (!ready) co_return member.failure(std::move(ready.error()));
      auto allowed = co_await member.axis->check_limits({member.target});
      if (!allowed) co_return member.failure(std::move(allowed.error()));
      auto twin = co_await member.axis->twin(member.movement);
      if (!twin) co_return member.failure(std::move(twin.error()));
      member.twin = std::move(*twin);
      if (!member.twin) {
        if (auto stop = stopped_by_other()) co_return stop;
        co_return member.failure(
            tmcl::bad_argument("how axis '" + member.axis->name() + "' moves cannot be foreseen",
                               "nobody has described its ramps, or its module does not tell how "
                               "they are set"));
      }
      member.before = member.axis->ramp_settings();
    }
    co_return std::nullopt;
  }

  static std::int32_t setting(const Member& member, std::uint8_t parameter) {
    const auto found = std::ranges::find(member.before, parameter, &Setting::parameter);
    return found == member.before.end() ? 0 : found->value;
  }

  static tmcl::PulsesPerSecond velocity_limit(const Member& member) {
    const tmcl::InternalVelocity own{setting(member, ap::max_velocity)};
    const auto limit = member.twin->to_pps(own);
    return std::min(limit, member.velocity.value_or(limit));
  }
  static tmcl::PulsesPerSecond2 acceleration_limit(const Member& member) {
    const auto parameter = greatest_acceleration_of(member.twin->model());
    const tmcl::InternalAcceleration own{setting(member, parameter)};
    const auto limit = member.twin->to_pps2(own);
    return std::min(limit, member.acceleration.value_or(limit));
  }

  // In the unit of the axis, if it has one.
  static awaitable<std::string> in_words(std::optional<tmcl::plan::Pace> pace, GatewayAxis& axis) {
    if (!pace) co_return "";
    const auto scale = co_await axis.scale();
    if (!scale || !*scale || axis.unit().empty()) {
      co_return fmt::format(": {:.4g} microsteps/s, {:.4g} microsteps/s^2", pace->velocity.value,
                            pace->acceleration.value);
    }
    co_return fmt::format(": {0:.4g} {2}/s, {1:.4g} {2}/s^2",
                          std::abs(to_user(pace->velocity, **scale).value),
                          to_user(pace->acceleration, **scale).value, axis.unit());
  }

  awaitable<Fault> plan() {
    std::vector<tmcl::plan::LineAxis> axes;
    for (const auto& member : members_) {
      axes.push_back({*member.twin, member.target, velocity_limit(member),
                      acceleration_limit(member), bus_of(member)});
    }
    line_.one_command = fits_one_command();
    auto work = [axes = std::move(axes), exchanges = exchanges(), duration = duration_] {
      return tmcl::plan::plan_line(axes, exchanges, duration);
    };
    auto planned = co_await elsewhere(*planner_, std::move(work));
    if (!planned) {
      const auto& member = members_[planned.error().axis];
      const auto pace = co_await in_words(planned.error().pace, *member.axis);
      co_return member.failure(tmcl::bad_argument("axis '" + member.axis->name() +
                                                  "': " + planned.error().message + pace));
    }
    line_.plan = std::move(*planned);
    co_return std::nullopt;
  }

  std::size_t bus_of(const Member& member) const {
    const auto bus = traffic_.find(member.axis->bus().name());
    return static_cast<std::size_t>(std::distance(traffic_.begin(), bus));
  }

  tmcl::plan::Exchanges exchanges() const {
    tmcl::plan::Exchanges exchanges;
    if (line_.one_command) return exchanges;
    for (const auto& [bus, traffic] : traffic_) exchanges.push_back(traffic.exchange());
    return exchanges;
  }

  void predict_skew() {
    std::vector<std::size_t> buses;
    for (const auto i : line_.plan.order) buses.push_back(bus_of(members_[i]));
    const auto starts = tmcl::plan::start_times(buses, exchanges());
    if (!starts.empty()) line_.predicted_skew = std::ranges::max(starts);
  }

  bool is_on_one_bus() const {
    return std::ranges::all_of(members_, [&](const Member& member) {
      return &member.axis->bus() == &members_.front().axis->bus();
    });
  }

  bool fits_one_command() const {
    return members_.size() > 1 && is_on_one_bus() &&
           std::ranges::all_of(members_, [&](const Member& member) {
             return member.axis->address().module == members_.front().axis->address().module;
           });
  }

  awaitable<Fault> load() {
    for (const auto i : line_.plan.order) {
      auto& member = members_[i];
      for (const auto wanted : line_.plan.axes[i].settings) {
        const Setting before{wanted.parameter, setting(member, wanted.parameter)};
        if (before == wanted) continue;
        member.changed.push_back(before);
        const auto set = co_await member.axis->set(wanted.parameter, wanted.value, member.movement);
        if (!set) co_return member.failure(set.error());
      }
      if (!line_.one_command) continue;
      auto script =
          tmcl::verbs::set_coordinate(member.axis->address(), scratch_coordinate, member.target);
      const auto told = co_await member.axis->perform(std::move(script), member.movement);
      if (!told) co_return member.failure(told.error());
    }
    co_return std::nullopt;
  }

  // ---- the starts ----

  struct Started {
    Fault fault;
    tmcl::TimePoint first = tmcl::TimePoint::max();
    tmcl::TimePoint last = tmcl::TimePoint::min();
  };

  awaitable<Fault> go() {
    predict_skew();
    started_ = true;
    begin_ = now();
    std::map<std::string, std::vector<std::size_t>> by_bus;
    for (const auto i : line_.plan.order) by_bus[members_[i].axis->bus().name()].push_back(i);
    std::vector<awaitable<Started>> tasks;
    for (const auto& [bus, axes] : by_bus)
      tasks.push_back(line_.one_command ? start_at_once(axes) : start_in_turn(axes));
    Started all;
    for (auto& one : co_await gather(std::move(tasks))) {
      if (one.fault && !all.fault) all.fault = std::move(one.fault);
      all.first = std::min(all.first, one.first);
      all.last = std::max(all.last, one.last);
    }
    if (all.last > all.first) line_.skew = all.last - all.first;
    for (const auto i : line_.plan.order)
      members_[i].axis->expect_arrival(begin_ + line_.plan.axes[i].arrival);
    co_return std::move(all.fault);
  }

  awaitable<Started> start_in_turn(std::vector<std::size_t> axes) {
    Started started;
    for (const auto i : axes) {
      auto& member = members_[i];
      if (broken_) break;  // on another bus
      const auto asked = now();
      auto script = tmcl::verbs::move_to(member.axis->address(), member.target);
      const auto moved = co_await member.axis->perform(std::move(script), start_options());
      if (!moved) {
        started.fault = failure_of_start(member, moved.error());
        broken_ = true;
        break;
      }
      started.last = asked + (now() - asked) / 2;
      started.first = std::min(started.first, started.last);
    }
    co_return started;
  }

  awaitable<Started> start_at_once(std::vector<std::size_t> axes) {
    Started started;
    tmcl::MotorMask motors{};
    for (const auto i : axes)
      motors.bits =
          static_cast<std::uint8_t>(motors.bits | (1U << members_[i].axis->address().motor));
    auto& first = members_[axes.front()];
    auto script = tmcl::verbs::move_motors_to_coordinate(
        first.axis->address().module, motors, tmcl::Together::each_for_itself, scratch_coordinate);
    const auto moved = co_await first.axis->perform(std::move(script), start_options());
    if (!moved) started.fault = failure_of_start(first, moved.error());
    started.first = started.last = now();
    co_return started;
  }

  // A stop of any of them is an objection to the start of each.
  RunOptions start_options() const {
    RunOptions options;
    options.permit = permit_;
    options.deadline = members_.front().movement.deadline;
    options.objection = [this]() -> std::optional<tmcl::Error> {
      const auto stopped = stopped_by_other();
      return stopped ? std::optional(stopped->error) : std::nullopt;
    };
    return options;
  }

  Fault stopped_by_other() const {
    for (const auto& member : members_) {
      if (auto stop = member.movement.objection()) return member.failure(std::move(*stop));
    }
    return std::nullopt;
  }

  LineFailure failure_of_start(const Member& member, const tmcl::Error& error) const {
    const bool was_stopped = error.code == tmcl::Errc::superseded_by_stop;
    return was_stopped ? stopped_by_other().value_or(member.failure(error)) : member.failure(error);
  }

  // ---- on the way ----

  static awaitable<void> guard(std::shared_ptr<LineRun> self) {
    Fault fault;
    while (!fault && !self->all_arrived()) {
      co_await rest(look_interval);
      fault = co_await self->look_at_all();
    }
    if (fault) {
      co_await self->stop_all();
      self->tell(*fault);
      self->tell_unstopped();
      co_await self->wait_for_standstill();
    }
    co_await self->end();
  }

  bool all_arrived() const {
    return std::ranges::all_of(line_.plan.order,
                               [&](std::size_t i) { return members_[i].arrived; });
  }

  void tell(const LineFailure& failure) const {
    const auto member = std::ranges::find(members_, failure.axis,
                                          [](const Member& one) { return one.axis->name(); });
    const auto& axis = *member->axis;
    axis.bus().emit(event_of(axis, GatewayEvent::Kind::line_broken, failure.error.message));
  }

  awaitable<Fault> look_at_all() {
    for (const auto i : line_.plan.order) {
      auto& member = members_[i];
      if (member.arrived) continue;
      if (auto stop = member.movement.objection()) co_return member.failure(std::move(*stop));
      const auto reading = co_await member.axis->read_state();
      if (!reading) co_return member.failure(reading.error());
      if (auto fault = judge(member, *reading)) co_return fault;
    }
    co_return std::nullopt;
  }

  // Its target is the line's.
  static std::string stands_short(const Member& member, const AxisReading& reading) {
    if (const auto& user = reading.user) {
      return fmt::format("stands at {0:.10g} {2}, short of its target {1:.10g} {2}",
                         user->position.value, user->target.value, member.axis->unit());
    }
    return fmt::format("stands at {}, short of its target {}", reading.state.position.value,
                       reading.state.target.value);
  }

  Fault judge(Member& member, const AxisReading& reading) const {
    const auto& state = reading.state;
    const auto name = "axis '" + member.axis->name() + "' ";
    const bool stands = state.velocity.value == 0;
    if (stands && state.position == member.target) {
      member.arrived = true;
      return std::nullopt;
    }
    const auto passed = now() - begin_;
    if (passed < time_to_begin) return std::nullopt;
    if (state.target != member.target)
      return member.failure(broken(name + "was sent elsewhere", "the other axes were stopped"));
    member.stood = stands ? member.stood + 1 : 0;
    if (member.stood > 2) {
      return member.failure(
          broken(name + stands_short(member, reading), "the other axes were stopped"));
    }
    if (passed > line_.plan.duration + tolerated_delay) {
      return member.failure(
          broken(name + "has not arrived when it should have", "all axes were stopped"));
    }
    return std::nullopt;
  }

  // ---- the end ----

  awaitable<void> stop_all() {
    std::vector<awaitable<tmcl::Result<void>>> stops;
    for (auto& member : members_)
      stops.push_back(patience_.insist([axis = member.axis] { return axis->stop(); }));
    auto results = co_await gather(std::move(stops));
    for (std::size_t i = 0; i < results.size(); ++i)
      if (!results[i]) members_[i].unstopped = std::move(results[i].error());
  }

  void tell_unstopped() const {
    for (const auto& member : members_) {
      if (!member.unstopped) continue;
      tell(member.failure(
          broken(not_stopped(member.axis->name()) + ": " + member.unstopped->message)));
    }
  }

  // To the one who waits for the answer.
  void add_unstopped(tmcl::Error& error) const {
    for (const auto& member : members_) {
      if (!member.unstopped) continue;
      error.message += "; " + not_stopped(member.axis->name());
      error.outcome = tmcl::Outcome::unknown;
    }
  }

  awaitable<void> wait_for_standstill() {
    const auto limit = now() + time_to_stand;
    for (auto& member : members_) {
      const auto look = [axis = member.axis] { return axis->read_state(); };
      while (now() < limit) {
        const auto reading = co_await patience_.insist(look);
        if (!reading || reading->state.velocity.value == 0) break;
        co_await rest(look_interval);
      }
    }
  }

  awaitable<void> end() {
    for (auto& member : members_) {
      co_await set_back(member);
      member.axis->release(permit_);
      if (member.unstopped) stop_as_soon_as_possible(member.axis, GatewayEvent::Kind::line_broken);
    }
  }

  // Backwards, as they were written: that order was a safe one.
  awaitable<void> set_back(Member& member) {
    std::string kept, why;
    for (const auto setting : std::views::reverse(member.changed)) {
      const auto write = [axis = member.axis, setting] {
        return axis->set(setting.parameter, setting.value, RunOptions{});
      };
      const auto set = co_await patience_.insist(write);
      if (set) continue;
      if (kept.empty()) why = set.error().message;
      kept += fmt::format("{}parameter {} was {} before", kept.empty() ? "" : ", ",
                          setting.parameter, setting.value);
    }
    if (kept.empty()) co_return;
    tell(member.failure(broken(fmt::format("axis '{}' keeps settings of the line: {}: {}",
                                           member.axis->name(), kept, why))));
  }

  std::vector<Member> members_;
  Permit permit_;
  std::optional<Duration> duration_;
  Workers* planner_;
  StartedLine line_;
  std::map<std::string, Traffic> traffic_;  // by the name of the bus
  bool started_ = false;
  bool broken_ = false;
  tmcl::TimePoint begin_{};
  LinkPatience patience_;
};

}  // namespace

std::uint8_t greatest_acceleration_of(const tmcl::Model& model) {
  constexpr auto tmc457_acceleration = tmcl::number_of("acceleration");
  return model.family == tmcl::Family::tmc457 ? tmc457_acceleration : ap::max_acceleration;
}

awaitable<tl::expected<StartedLine, LineFailure>> start_line(LineOrder order) {
  const auto run = std::make_shared<LineRun>(std::move(order));
  auto started = co_await run->start();
  co_return started;
}

}  // namespace tmcld
