#include "gateway/journey/awaited_run.hpp"

#include <exception>
#include <utility>

#include "gateway/standing_stop.hpp"
#include "tmcl/drive_report.hpp"
#include "tmcl/ensure.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld {

using boost::asio::awaitable;
using tmcl::plan::DriveFault;

awaitable<std::optional<tmcl::Error>> AwaitedRun::pass(std::shared_ptr<AwaitedRun> self) {
  if (auto taken = co_await self->take_axes()) co_return taken;
  std::exception_ptr failure;
  try {
    co_await self->drive(self->what_drives(), [] { return false; });
    failure = self->failure();
  } catch (...) {
    failure = std::current_exception();
  }
  self->release(&self->report());
  self->ended_ = true;
  self->tell();
  if (failure) std::rethrow_exception(failure);
  self->tell_fault();
  co_return std::nullopt;
}

awaitable<void> AwaitedRun::until_told(std::shared_ptr<AwaitedRun> self, tmcl::TimePoint until) {
  const auto wake = std::make_shared<Wake>(self->executor_);
  self->waiting_.push_back(wake);
  co_await wake->wait_until(until);
  std::erase(self->waiting_, wake);
}

void AwaitedRun::tell() {
  for (const auto& wake : std::exchange(waiting_, {})) wake->notify();
}

void AwaitedRun::end(DriveFault why) {
  what_drives().stop(std::move(why));
  woken_.notify();
}

std::vector<std::string> AwaitedRun::axis_names() const {
  std::vector<std::string> names;
  for (const auto& member : members_) names.push_back(member.axis->name());
  return names;
}

std::vector<std::string> AwaitedRun::unstopped() const {
  tmcl::ensure(ended_);
  std::vector<std::string> names;
  for (const auto& unstopped : report().unstopped)
    names.push_back(members_[unstopped.axis].axis->name());
  return names;
}

std::string AwaitedRun::text_of(const DriveFault& fault) const {
  auto text = tmcl::text_of(fault, axis_names());
  for (const auto& axis : unstopped()) text += "; " + not_stopped(axis);
  for (const auto& [word, why] : report().unswitched) {
    text += "; M" + std::to_string(word) +
            " was not carried out, and what it switches off may be on (" + why.message + ")";
  }
  return text;
}

awaitable<std::optional<tmcl::Error>> AwaitedRun::take_axes() {
  const auto self = std::static_pointer_cast<AwaitedRun>(shared_from_this());
  tmcl::ensure(!members_.empty());
  const ClaimOwner claim_owner{claim_kind_, members_.front().movement.permit, self};
  auto failure = co_await claim(claim_owner);
  if (failure) co_return failure;
  for (auto& member : members_) {
    auto admitted = co_await member.axis->admit(action::FollowPath{}, member.movement);
    if (!admitted) {
      release(nullptr);
      co_return error_of(*member.axis, std::move(admitted.error()));
    }
    member.admitted = std::move(*admitted);
  }
  co_return std::nullopt;
}

awaitable<tmcl::TimePoint> AwaitedRun::before_step() {
  if (now() >= progress_due_) {
    progress_due_ = now() + progress_interval;
    tell_progress();
  }
  co_return progress_due_;
}

// Not stop(): what moves them afterwards is of the same call.
GatewayAxis::Awaitable<void> AwaitedRun::stop(GatewayAxis& axis) {
  return axis.stop_without_revoking();
}

GatewayAxis::Awaitable<void> AwaitedRun::write(const DriveMember& member,
                                               tmcl::plan::Setting setting, bool /*restores*/) {
  const bool moves = setting.parameter == tmcl::axis_parameter::target_position;
  auto options = movement_of(member);
  // A setting is set back after a stop, too.
  if (!moves) options.objection = {};
  return member.axis->write(setting.parameter, setting.value, std::move(options));
}

void AwaitedRun::tell_fault() const {
  const auto& fault = report().fault;
  if (!fault || is_before_motion(fault->kind)) return;
  const auto& axis = *members_[fault->axis.value_or(0)].axis;
  auto event = event_of(axis, when_broken_, text_of(*fault));
  event.unrestored = unrestored_of(axis);
  axis.bus().emit(std::move(event));
}

}  // namespace tmcld
