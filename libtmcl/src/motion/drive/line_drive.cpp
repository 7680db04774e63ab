#include "tmcl/plan/line_drive.hpp"

#include <algorithm>
#include <utility>

#include "motion/drive/drive_runner.hpp"

namespace tmcl::plan {
namespace {

constexpr Duration tolerated_delay = std::chrono::seconds(2);
constexpr Duration time_to_stand = std::chrono::seconds(10);

}  // namespace

class LineDrive::Runner final : public DriveRunner {
 public:
  Runner(Line line, std::vector<LineDriveAxis> axes, bool one_command)
      : DriveRunner(axes.size()),
        line_(std::move(line)),
        axes_(std::move(axes)),
        one_command_(one_command) {
    for (std::size_t i = 0; i < axes_.size(); ++i)
      for (const auto setting : axes_[i].before) settings_[i].know(setting);
  }

  Phase phase() const { return phase_; }
  const LineReport& report() const { return report_; }

 private:
  Script<Fault> whole() override {
    auto wrong = co_await load();
    if (!wrong) {
      wrong = co_await move();
      if (wrong) {
        report_.fault = wrong;
        co_await end_early();
      }
    }
    report_.fault = wrong;
    phase_ = Phase::restoring;
    heeds_stop_ = false;
    co_await restore(report_);
    phase_ = Phase::ended;
    co_return wrong;
  }

  Script<Fault> load() {
    for (const auto i : line_.order) {
      for (const auto wanted : line_.axes[i].settings) {
        auto wrong = co_await set(i, wanted);
        if (!wrong) wrong = asked_to_stop();
        if (wrong) co_return wrong;
      }
      if (!one_command_) continue;
      co_await command({Kind::set_coordinate, i, 0, axes_[i].target.value});
      if (!answer_) co_return refusal(i);
    }
    co_return asked_to_stop();
  }

  std::vector<DriveCommands> starts() const {
    if (line_.order.empty()) return {};
    if (one_command_) {
      std::int32_t motors = 0;
      for (const auto i : line_.order) motors |= 1 << axes_[i].motor;
      return {DriveCommands{{Kind::move_motors, line_.order.front(), 0, motors}}};
    }
    std::vector<DriveCommands> by_bus(axes_.size());
    for (const auto i : line_.order)
      by_bus[axes_[i].bus].push_back({Kind::move_to, i, 0, axes_[i].target.value});
    std::erase_if(by_bus, [](const auto& commands) { return commands.empty(); });
    return by_bus;
  }

  Script<Fault> move() {
    phase_ = Phase::starting;
    report_.begin = now_;
    auto commands = starts();
    co_await side_by_side(std::move(commands), true);
    auto first = TimePoint::max();
    auto last = TimePoint::min();
    for (const auto& done : done_) {
      if (!done.answer) co_return refusal(done.command.axis, done.answer.error());
      const auto started = done.asked + (done.ended - done.asked) / 2;
      first = std::min(first, started);
      last = std::max(last, started);
    }
    if (stop_asked_) co_return stop_asked_;
    if (last > first) report_.skew = last - first;
    phase_ = Phase::running;
    std::vector<Goal> goals;
    for (const auto i : line_.order) goals.push_back({i, axes_[i].target});
    auto wrong = co_await arrive(std::move(goals), report_.begin,
                                 report_.begin + line_.duration + tolerated_delay);
    co_return wrong;
  }

  // Also what could not be stopped may come to rest before its settings change.
  Script<Fault> end_early() {
    phase_ = Phase::stopping;
    co_await stop_all(report_, 1);
    const auto limit = now_ + time_to_stand;
    co_await see_all_stand(report_, limit);
    phase_ = Phase::stopped;
    for (const auto& unstopped : report_.unstopped) co_await come_to_rest(unstopped.axis, limit);
    co_return std::nullopt;
  }

  Line line_;
  std::vector<LineDriveAxis> axes_;
  bool one_command_;
  LineReport report_;
  Phase phase_ = Phase::loading;
};

LineDrive::LineDrive(Line line, std::vector<LineDriveAxis> axes, bool one_command)
    : Drive(std::make_unique<Runner>(std::move(line), std::move(axes), one_command)) {}
LineDrive::~LineDrive() = default;

const LineDrive::Runner& LineDrive::line() const { return static_cast<const Runner&>(*runner_); }
LineDrive::Phase LineDrive::phase() const { return line().phase(); }
const LineReport& LineDrive::report() const { return line().report(); }

}  // namespace tmcl::plan
