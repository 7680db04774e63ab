#include "gateway/journey/line.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <boost/asio/this_coro.hpp>

#include "async/spawn.hpp"
#include "gateway/journey/drive_run.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/drive_report.hpp"
#include "tmcl/ensure.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/line_drive.hpp"
#include "tmcl/plan/path_preparation.hpp"
#include "tmcl/plan/ramp_limits.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::Duration;
using tmcl::plan::Setting;
using Fault = std::optional<tmcl::Error>;

namespace ap = tmcl::axis_parameter;
namespace plan = tmcl::plan;

tmcl::Error broken(std::string message) {
  tmcl::Error error;
  error.code = tmcl::Errc::move_interrupted;
  error.outcome = tmcl::Outcome::done;
  error.message = std::move(message);
  return error;
}

/// How long the exchanges of a line have taken on one bus.
class ExchangeDurations {
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
struct Member {
  LineMember wanted;
  std::optional<plan::AxisTwin> twin{};
  std::vector<Setting> before{};  // its ramp's settings

  GatewayAxis& axis() const { return *wanted.axis; }
  tmcl::Error failure(tmcl::Error error) const { return error_of(axis(), std::move(error)); }
};

class LineRun final : public DriveRun {
 public:
  LineRun(const boost::asio::any_io_executor& executor, LineOrder order)
      : DriveRun(executor, {}),
        permit_(order.permit),
        duration_(order.duration),
        planner_(order.planner),
        on_end_(std::move(order.on_end)) {
    tmcl::ensure(!order.members.empty() && planner_ != nullptr);
    for (auto& member : order.members) {
      auto movement = member.axis->begin_movement(permit_, order.deadline);
      auto& traffic = traffic_[member.axis->bus().name()];
      movement.on_answer = [&traffic](Duration exchange) { traffic.note(exchange); };
      members_.push_back({member.axis, std::move(movement)});
      line_members_.push_back({std::move(member)});
    }
  }

  awaitable<tmcl::Result<StartedLine>> start() {
    const ClaimOwner claim_owner{ClaimKind::line, permit_};
    if (auto fault = co_await claim(claim_owner)) co_return tl::unexpected(std::move(*fault));
    Fault fault;
    std::exception_ptr failure;
    try {
      fault = co_await look();
      if (!fault) fault = co_await make_plan();
      if (!fault) fault = co_await go();
      failure = this->failure();
    } catch (...) {
      failure = std::current_exception();
    }
    if (fault || failure) {
      leave_axes();
      tell_unrestored();
      if (failure) std::rethrow_exception(failure);
      co_return tl::unexpected(std::move(*fault));
    }
    const auto executor = co_await boost::asio::this_coro::executor;
    spawn(executor, guard(self()));
    co_return line_;
  }

 private:
  std::shared_ptr<LineRun> self() { return std::static_pointer_cast<LineRun>(shared_from_this()); }

  void leave_axes() { release(drive_ ? &drive_->report() : nullptr); }

  awaitable<Fault> look() {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      auto& member = line_members_[i];
      auto& axis = member.axis();
      const action::MoveTo action{{member.wanted.target}};
      auto admitted = co_await axis.admit(action, members_[i].movement);
      if (!admitted) co_return member.failure(std::move(admitted.error()));
      members_[i].admitted = std::move(*admitted);
      auto twin = co_await axis.twin(members_[i].movement, tmcl::Proof::twice);
      if (!twin) co_return member.failure(std::move(twin.error()));
      member.twin = std::move(*twin);
      if (!member.twin) {
        if (auto stop = stopped_by_other()) co_return stop;
        co_return member.failure(
            tmcl::bad_argument("how axis '" + axis.name() + "' moves cannot be foreseen",
                               "its ramps are not described, or its module does not tell how "
                               "they are set"));
      }
      member.before = axis.ramp_settings();
    }
    co_return std::nullopt;
  }

  Fault stopped_by_other() const {
    for (const auto& member : members_) {
      if (auto stop = member.movement.objection()) return error_of(*member.axis, std::move(*stop));
    }
    return std::nullopt;
  }

  static tmcl::PulsesPerSecond velocity_limit(const Member& member) {
    const auto own = plan::ramp_limits(member.twin->model(), member.before).velocity;
    const auto limit = member.twin->to_pps(tmcl::InternalVelocity{own});
    return std::min(limit, member.wanted.velocity.value_or(limit));
  }
  static tmcl::PulsesPerSecond2 acceleration_limit(const Member& member) {
    const auto own = plan::ramp_limits(member.twin->model(), member.before).acceleration;
    const auto limit = member.twin->to_pps2(tmcl::InternalAcceleration{own});
    return std::min(limit, member.wanted.acceleration.value_or(limit));
  }

  // In the unit of the axis, if it has one.
  static awaitable<std::string> in_words(std::optional<plan::Pace> pace, GatewayAxis& axis) {
    if (!pace) co_return "";
    const auto scale = co_await axis.scale();
    if (!scale || !*scale || axis.unit().empty()) {
      co_return fmt::format(": {} microsteps/s, {} microsteps/s^2",
                            tmcl::plain_number(pace->velocity.value, 4),
                            tmcl::plain_number(pace->acceleration.value, 4));
    }
    co_return fmt::format(": {0} {2}/s, {1} {2}/s^2",
                          tmcl::plain_number(std::abs(to_user(pace->velocity, **scale).value), 4),
                          tmcl::plain_number(to_user(pace->acceleration, **scale).value, 4),
                          axis.unit());
  }

  awaitable<Fault> make_plan() {
    std::vector<plan::LineAxis> axes;
    for (const auto& member : line_members_) {
      axes.push_back({*member.twin, member.wanted.target, velocity_limit(member),
                      acceleration_limit(member), bus_of(member)});
    }
    line_.one_command = fits_one_command();
    auto work = [axes = std::move(axes), exchanges = exchanges(), duration = duration_] {
      return plan::plan_line(axes, exchanges, duration);
    };
    auto planned = co_await planner_->plan(std::move(work));
    if (!planned) {
      const auto& member = line_members_[planned.error().axis];
      const auto pace = co_await in_words(planned.error().pace, member.axis());
      co_return member.failure(tmcl::bad_argument("axis '" + member.axis().name() +
                                                  "': " + planned.error().message + pace));
    }
    line_.plan = std::move(*planned);
    co_return std::nullopt;
  }

  std::size_t bus_of(const Member& member) const {
    const auto bus = traffic_.find(member.axis().bus().name());
    return static_cast<std::size_t>(std::distance(traffic_.begin(), bus));
  }

  plan::ExchangeTimes exchanges() const {
    plan::ExchangeTimes exchanges;
    if (line_.one_command) return exchanges;
    for (const auto& [bus, traffic] : traffic_) exchanges.push_back(traffic.exchange());
    return exchanges;
  }

  void predict_skew() {
    std::vector<std::size_t> buses;
    for (const auto i : line_.plan.order) buses.push_back(bus_of(line_members_[i]));
    const auto starts = plan::start_times(buses, exchanges());
    if (!starts.empty()) line_.predicted_skew = std::ranges::max(starts);
  }

  bool is_on_one_bus() const {
    return std::ranges::all_of(line_members_, [&](const Member& member) {
      return &member.axis().bus() == &line_members_.front().axis().bus();
    });
  }

  bool fits_one_command() const {
    return line_members_.size() > 1 && is_on_one_bus() &&
           std::ranges::all_of(line_members_, [&](const Member& member) {
             return member.axis().address().module == line_members_.front().axis().address().module;
           });
  }

  // ---- the way ----

  awaitable<Fault> go() {
    std::vector<plan::LineDriveAxis> axes;
    for (const auto& member : line_members_) {
      axes.push_back(
          {member.wanted.target, member.before, bus_of(member), member.axis().address().motor});
    }
    drive_.emplace(line_.plan, std::move(axes), line_.one_command);
    co_await drive(*drive_, [this] { return drive_->phase() == plan::LineDrive::Phase::running; });
    const auto& report = drive_->report();
    if (report.fault) {
      auto fault = co_await failure_of(*report.fault);
      add_unstopped(fault);
      co_return fault;
    }
    predict_skew();
    line_.skew = report.skew;
    for (const auto i : line_.plan.order)
      members_[i].axis->expect_arrival(report.begin + line_.plan.axes[i].arrival);
    line_.journal_failure = journal_failure();
    is_told_ = false;
    co_return std::nullopt;
  }

  static awaitable<void> guard(std::shared_ptr<LineRun> self) {
    std::exception_ptr failure;
    try {
      co_await self->drive(*self->drive_, [] { return false; });
      failure = self->failure();
    } catch (...) {
      failure = std::current_exception();
    }
    self->leave_axes();
    self->tell_unrestored();
    const auto& fault = self->drive_->report().fault;
    self->on_end_(failure ? "internal_error" : fault ? name_of(*fault) : "");
    if (failure) std::rethrow_exception(failure);
  }

  bool runs_by_itself() const override { return true; }
  // What goes wrong on the way is told as soon as all have been stopped.
  awaitable<tmcl::TimePoint> before_step() override {
    if (!is_told_ && drive_->phase() > plan::LineDrive::Phase::stopping && drive_->report().fault) {
      is_told_ = true;
      co_await tell_fault();
    }
    co_return tmcl::TimePoint::max();
  }

  GatewayAxis::Awaitable<void> stop(GatewayAxis& axis) override { return axis.stop(); }

  // The call that stopped it may set it back.
  GatewayAxis::Awaitable<void> write(const DriveMember& member, Setting setting,
                                     bool restores) override {
    auto options = restores ? RunOptions{} : movement_of(member);
    if (!restores) options.on_answer = member.movement.on_answer;
    // What was there before may come back, wherever the limits of the axis are.
    if (restores) options.permit.exceeds_limits = true;
    return member.axis->set(setting.parameter, setting.value, std::move(options));
  }

  // ---- in words ----

  // In the unit of the axis, if it has one.
  awaitable<std::string> stands_short(std::size_t axis, tmcl::Microsteps here) const {
    const auto& member = line_members_[axis];
    const auto scale = co_await member.axis().scale();
    if (!scale || !*scale || member.axis().unit().empty()) co_return "";
    co_return fmt::format("stands at {0} {2}, short of its target {1} {2}",
                          tmcl::plain_number(to_user(here, **scale).value, 10),
                          tmcl::plain_number(to_user(member.wanted.target, **scale).value, 10),
                          member.axis().unit());
  }

  awaitable<tmcl::Error> failure_of(plan::DriveFault fault) const {
    const auto axis = fault.axis.value_or(0);
    const auto& member = line_members_[axis];
    if (fault.error) co_return member.failure(std::move(*fault.error));
    if (fault.stands_at) {
      auto in_unit = co_await stands_short(axis, *fault.stands_at);
      if (!in_unit.empty()) fault.message = std::move(in_unit);
    }
    co_return member.failure(broken("axis '" + member.axis().name() + "' " + fault.message));
  }

  void tell(std::size_t axis, std::string text) const {
    const auto& member = *members_[axis].axis;
    auto event = event_of(member, GatewayEvent::Kind::line_broken, std::move(text));
    event.unrestored = unrestored_of(member);
    member.bus().emit(std::move(event));
  }

  awaitable<void> tell_fault() const {
    const auto& report = drive_->report();
    const auto failure = co_await failure_of(*report.fault);
    tell(report.fault->axis.value_or(0), failure.message);
    for (const auto& [axis, why] : report.unstopped)
      tell(axis, not_stopped(members_[axis].axis->name()) + ": " + why.message);
  }

  // To the one who waits for the answer.
  void add_unstopped(tmcl::Error& error) const {
    for (const auto& unstopped : drive_->report().unstopped) {
      error.message += "; " + not_stopped(members_[unstopped.axis].axis->name());
      error.outcome = tmcl::Outcome::unknown;
    }
  }

  void tell_unrestored() const {
    if (!drive_) return;
    struct Kept {
      std::string settings;
      std::string why;  // of the first
    };
    std::map<std::size_t, Kept> all;
    for (const auto& [axis, before, why] : drive_->report().unrestored) {
      auto& kept = all[axis];
      if (kept.settings.empty()) kept.why = why.message;
      kept.settings +=
          fmt::format("{}parameter {} was {} before", kept.settings.empty() ? "" : ", ",
                      before.parameter, before.value);
    }
    for (const auto& [axis, kept] : all) {
      tell(axis, fmt::format("axis '{}' keeps settings of the line: {}: {}",
                             members_[axis].axis->name(), kept.settings, kept.why));
    }
  }

  std::vector<Member> line_members_;
  Permit permit_;
  std::optional<Duration> duration_;
  Planner* planner_;
  std::function<void(std::string_view fault)> on_end_;
  StartedLine line_;
  std::map<std::string, ExchangeDurations> traffic_;  // by the name of the bus
  std::optional<plan::LineDrive> drive_;
  bool is_told_ = true;  // who waits for the start is answered
};

}  // namespace

awaitable<tmcl::Result<StartedLine>> start_line(LineOrder order) {
  const auto executor = co_await boost::asio::this_coro::executor;
  const auto run = std::make_shared<LineRun>(executor, std::move(order));
  auto started = co_await run->start();
  co_return started;
}

}  // namespace tmcld
