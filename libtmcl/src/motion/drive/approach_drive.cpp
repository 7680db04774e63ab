#include "tmcl/plan/approach_drive.hpp"

#include <algorithm>
#include <utility>

#include "motion/drive/drive_runner.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

}  // namespace

Microsteps first_stop(const Approach& approach, Microsteps position, InternalVelocity velocity,
                      Microsteps target) {
  const bool is_beyond = approach.upwards ? position > target : position < target;
  if (!is_beyond && velocity.value == 0) return target;
  const auto beyond =
      std::int64_t{target.value} + (approach.upwards ? -1 : 1) * std::int64_t{approach.distance};
  return {static_cast<std::int32_t>(
      std::clamp<std::int64_t>(beyond, approach.range.least, approach.range.greatest))};
}

class ApproachDrive::Runner final : public DriveRunner {
 public:
  explicit Runner(Approach approach) : DriveRunner(1), approach_(approach) {}

  std::optional<std::uint64_t> wish(Microsteps target) {
    if (is_ending_) return std::nullopt;
    wish_ = target;
    end_wait();
    return ++last_wish_;
  }
  std::uint64_t done() const { return done_wish_; }
  const DriveReport& report() const { return report_; }

 private:
  Script<Fault> whole() override {
    report_.fault = co_await go();
    is_ending_ = true;
    if (report_.fault && was_sent_) co_await stop_and_rest(report_);
    co_return report_.fault;
  }

  Script<Fault> go() {
    Fault wrong;
    while (!wrong && (wish_ || watched_)) {
      if (asked_to_stop()) co_return asked_to_stop();
      if (const auto wish = std::exchange(wish_, std::nullopt)) {
        wrong = co_await set_out(*wish);
      } else {
        wrong = co_await look_on();
      }
    }
    co_return wrong;
  }

  Script<Fault> set_out(Microsteps target) {
    const auto number = last_wish_;
    co_await command({Kind::get, 0, ap::actual_velocity, 0});
    if (!answer_) co_return refusal(0);
    const InternalVelocity velocity{*answer_};
    co_await command({Kind::get, 0, ap::actual_position, 0});
    if (!answer_) co_return refusal(0);
    target_ = target;
    auto wrong = co_await send_to(first_stop(approach_, {*answer_}, velocity, target));
    if (!wrong) done_wish_ = number;
    co_return wrong;
  }

  Script<Fault> send_to(Microsteps place) {
    if (asked_to_stop()) co_return asked_to_stop();
    const auto begin = now_;
    was_sent_ = true;
    co_await command({Kind::move_to, 0, 0, place.value});
    if (!answer_) co_return refusal(0);
    watched_ = {{0, place}, Arrival(place, begin, {most_standing, {}, time_to_begin})};
    co_return std::nullopt;
  }

  Script<Fault> look_on() {
    co_await until(now_ + drive_look_interval);
    if (wish_ || asked_to_stop()) co_return std::nullopt;
    auto wrong = co_await look(*watched_, TimePoint::max());
    if (wrong || watched_->arrival || wish_) co_return wrong;
    const bool is_there = watched_->goal.target == target_;
    watched_.reset();
    if (!is_there) wrong = co_await send_to(target_);
    co_return wrong;
  }

  Approach approach_;
  std::optional<Microsteps> wish_;
  Microsteps target_{};
  std::uint64_t last_wish_ = 0;
  std::uint64_t done_wish_ = 0;
  std::optional<Watched> watched_;
  bool was_sent_ = false;
  bool is_ending_ = false;
  DriveReport report_;
};

ApproachDrive::ApproachDrive(Approach approach) : Drive(std::make_unique<Runner>(approach)) {}
ApproachDrive::~ApproachDrive() = default;

ApproachDrive::Runner& ApproachDrive::approach() { return static_cast<Runner&>(*runner_); }
const ApproachDrive::Runner& ApproachDrive::approach() const {
  return static_cast<const Runner&>(*runner_);
}
std::optional<std::uint64_t> ApproachDrive::wish(Microsteps target) {
  return approach().wish(target);
}
std::uint64_t ApproachDrive::done() const { return approach().done(); }
const DriveReport& ApproachDrive::report() const { return approach().report(); }

}  // namespace tmcl::plan
