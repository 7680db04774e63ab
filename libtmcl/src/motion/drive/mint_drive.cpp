#include "tmcl/plan/mint_drive.hpp"

#include <map>
#include <utility>

#include "motion/drive/drive_runner.hpp"

namespace tmcl::plan {

class MintDrive::Runner final : public DriveRunner {
 public:
  Runner(std::vector<MintDriveGroup> groups, std::vector<MintDriveAxis> axes)
      : DriveRunner(axes.size()), groups_(std::move(groups)), axes_(std::move(axes)) {
    report_.took.reserve(groups_.size());
  }

  const MintReport& report() const { return report_; }
  const std::vector<MintDriveGroup>& groups() const { return groups_; }
  TimePoint group_begin() const { return begin_; }

 private:
  Script<Fault> whole() override {
    for (const auto& group : groups_) {
      begin_ = now_;
      auto wrong = co_await pass(group);
      if (!wrong) {
        report_.took.push_back(now_ - begin_);
        continue;
      }
      report_.fault = std::move(wrong);
      break;
    }
    heeds_stop_ = false;
    co_await restore(report_);
    co_return report_.fault;
  }

  Script<Fault> pass(const MintDriveGroup& group) {
    // Its axes stand where it sends them: a program of such groups must not keep its runner busy.
    if (group.moves.empty()) co_await until(now_ + drive_look_interval);
    for (const auto& move : group.moves) {
      auto wrong = co_await set_ramp(move);
      if (wrong) co_return wrong;
    }
    auto wrong = co_await load(group);
    if (!wrong) wrong = asked_to_stop();
    if (wrong) co_return wrong;
    wrong = co_await move(group);
    if (wrong) co_await stop_and_rest(report_);
    co_return wrong;
  }

  Script<Fault> set_ramp(const MintDriveMove& move) {
    const auto axis = move.axis;
    for (const auto setting : move.ramp) {
      auto wrong = co_await know(axis, setting.parameter);
      if (wrong) co_return wrong;
    }
    for (const auto setting : settings_[axis].in_safe_order(move.ramp)) {
      auto wrong = co_await set(axis, setting);
      if (!wrong) wrong = asked_to_stop();
      if (wrong) co_return wrong;
    }
    co_return std::nullopt;
  }

  /// Leaves in starts_ what is to start the group then.
  Script<Fault> load(const MintDriveGroup& group) {
    starts_.clear();
    std::map<std::size_t, std::vector<MintDriveMove>> modules;
    for (const auto& move : group.moves) modules[axes_[move.axis].module].push_back(move);
    for (const auto& [module, moves] : modules) {
      auto wrong = co_await load_module(moves);
      if (wrong) co_return wrong;
    }
    co_return std::nullopt;
  }

  Script<Fault> load_module(const std::vector<MintDriveMove>& moves) {
    DriveCommand start{Kind::move_motors, moves.front().axis, 0, 0};
    bool loads = moves.size() > 1;
    for (std::size_t i = 0; i < moves.size() && loads; ++i) {
      co_await command({Kind::set_coordinate, moves[i].axis, 0, moves[i].target.value});
      loads = answer_.has_value();
      if (!loads && answer_.error().outcome != Outcome::refused) co_return refusal(moves[i].axis);
      if (asked_to_stop()) co_return asked_to_stop();
      start.value |= 1 << axes_[moves[i].axis].motor;
    }
    if (loads) {
      starts_.push_back(start);
      co_return std::nullopt;
    }
    for (const auto& move : moves)
      starts_.push_back({Kind::move_to, move.axis, 0, move.target.value});
    co_return std::nullopt;
  }

  Script<Fault> move(const MintDriveGroup& group) {
    const auto begin = now_;
    for (const auto& start : starts_) {
      co_await command(start);
      if (!answer_) co_return refusal(start.axis);
      if (asked_to_stop()) co_return asked_to_stop();
    }
    std::vector<Goal> goals;
    for (const auto& move : group.moves) goals.push_back({move.axis, move.target});
    // How long the real ramps take is not known to the microsecond, and a program has time.
    auto wrong = co_await arrive(std::move(goals), begin, TimePoint::max());
    co_return wrong;
  }

  std::vector<MintDriveGroup> groups_;
  std::vector<MintDriveAxis> axes_;
  DriveCommands starts_;
  MintReport report_;
  TimePoint begin_ = TimePoint::max();
};

MintDrive::MintDrive(std::vector<MintDriveGroup> groups, std::vector<MintDriveAxis> axes)
    : Drive(std::make_unique<Runner>(std::move(groups), std::move(axes))) {}
MintDrive::~MintDrive() = default;

const MintDrive::Runner& MintDrive::program() const { return static_cast<const Runner&>(*runner_); }
const MintReport& MintDrive::report() const { return program().report(); }
const std::vector<MintDriveGroup>& MintDrive::groups() const { return program().groups(); }
TimePoint MintDrive::group_begin() const { return program().group_begin(); }

}  // namespace tmcl::plan
