#include "gateway/path_run.hpp"

#include <exception>
#include <utility>

#include "tmcl/drive_report.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::plan::DriveFault;

}  // namespace

PathRun::PathRun(const boost::asio::any_io_executor& executor, tmcl::plan::Course course,
                 std::vector<PathMember> members, std::vector<tmcl::plan::StreamAxis> axes,
                 tmcl::plan::StreamOptions options, OnProgress on_progress)
    : DriveRun(executor, std::move(members)),
      course_(std::move(course)),
      stream_(course_, std::move(axes), options),
      on_progress_(std::move(on_progress)) {}

std::vector<std::string> PathRun::axis_names() const {
  std::vector<std::string> names;
  for (const auto& member : members_) names.push_back(member.axis->name());
  return names;
}

awaitable<tl::expected<tmcl::plan::StreamReport, AxisFailure>> PathRun::pass(
    std::shared_ptr<PathRun> self) {
  if (auto taken = co_await self->take_axes()) co_return tl::unexpected(std::move(*taken));
  std::exception_ptr failure;
  try {
    co_await self->drive(self->stream_, [] { return false; });
    failure = self->failure();
  } catch (...) {
    failure = std::current_exception();
  }
  self->release();
  for (const auto& unstopped : self->stream_.report().unstopped)
    stop_as_soon_as_possible(self->members_[unstopped.axis].axis, GatewayEvent::Kind::path_broken);
  self->ended_ = true;
  if (failure) std::rethrow_exception(failure);
  self->tell_fault();
  co_return self->stream_.report();
}

void PathRun::pause(bool on) {
  stream_.pause(on);
  woken_.notify();
}

void PathRun::end(DriveFault why) {
  stream_.stop(std::move(why));
  woken_.notify();
}

awaitable<std::optional<AxisFailure>> PathRun::take_axes() {
  const auto self = std::static_pointer_cast<PathRun>(shared_from_this());
  const Claimant claimant{Mover::path, members_.front().movement.permit, self};
  auto failure = co_await claim(claimant);
  if (failure) co_return failure;
  for (auto& member : members_) {
    auto admitted = co_await member.axis->admit(intent::FollowPath{}, member.movement);
    if (!admitted) {
      release();
      co_return AxisFailure{std::move(admitted.error()), member.axis->name()};
    }
    member.admitted = std::move(*admitted);
  }
  co_return std::nullopt;
}

awaitable<tmcl::TimePoint> PathRun::before_step() {
  if (now() >= progress_due_) {
    progress_due_ = now() + path_progress_interval;
    on_progress_(*this);
  }
  co_return progress_due_;
}

// Not stop(): what moves them afterwards is of the same call.
GatewayAxis::Awaitable<void> PathRun::stop(GatewayAxis& axis) { return axis.brake(); }

GatewayAxis::Awaitable<void> PathRun::write(const DriveMember& member, tmcl::plan::Setting setting,
                                            bool /*restores*/) {
  const bool moves = setting.parameter == tmcl::axis_parameter::target_position;
  auto options = movement_of(member);
  // A setting is set back after a stop, too.
  if (!moves) options.objection = {};
  return member.axis->write(setting.parameter, setting.value, std::move(options));
}

void PathRun::tell_fault() const {
  const auto& fault = stream_.report().fault;
  if (!fault || is_before_motion(fault->kind)) return;
  const auto& axis = *members_[fault->axis.value_or(0)].axis;
  axis.bus().emit(event_of(axis, GatewayEvent::Kind::path_broken, text_of(*fault)));
}

std::string PathRun::text_of(const DriveFault& fault) const {
  auto text = tmcl::text_of(fault, axis_names());
  for (const auto& axis : unstopped()) text += "; " + not_stopped(axis);
  return text;
}

std::vector<std::string> PathRun::unstopped() const {
  std::vector<std::string> names;
  for (const auto& unstopped : stream_.report().unstopped)
    names.push_back(members_[unstopped.axis].axis->name());
  return names;
}

}  // namespace tmcld
