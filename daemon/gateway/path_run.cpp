#include "gateway/path_run.hpp"

#include <algorithm>
#include <exception>
#include <set>
#include <utility>

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/gather.hpp"
#include "tmcl/plan/path_run.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using std::chrono::milliseconds;
using tmcl::plan::PathStream;
using tmcl::plan::StreamAnswer;
using tmcl::plan::StreamCommand;
using tmcl::plan::StreamFault;

// A link that was lost may come back: an axis that turns must be stopped all the same.
constexpr tmcl::Duration time_for_link = std::chrono::seconds(5);
constexpr tmcl::Duration link_look_interval = milliseconds(50);

tmcl::TimePoint now() { return std::chrono::steady_clock::now(); }

awaitable<void> rest(tmcl::Duration duration) {
  boost::asio::steady_timer timer(co_await boost::asio::this_coro::executor);
  timer.expires_after(duration);
  co_await timer.async_wait(boost::asio::use_awaitable);
}

template <class T>
StreamAnswer answer_of(const tmcl::Result<T>& result) {
  if (!result) return tl::unexpected(describe(result.error()));
  if constexpr (std::is_same_v<T, std::int32_t>) {
    return *result;
  } else {
    return 0;
  }
}

awaitable<StreamAnswer> stop_now(std::shared_ptr<GatewayAxis> axis) {
  const auto limit = now() + time_for_link;
  while (true) {
    const auto stopped = co_await axis->brake();
    const bool lost = !stopped && stopped.error().code == tmcl::Errc::link_lost;
    if (!lost || now() > limit) co_return answer_of(stopped);
    co_await rest(link_look_interval);
  }
}

}  // namespace

PathRun::PathRun(const boost::asio::any_io_executor& executor, tmcl::plan::Course course,
                 std::vector<PathMember> members, std::vector<tmcl::plan::StreamAxis> axes,
                 tmcl::plan::StreamOptions options, OnProgress on_progress)
    : course_(std::move(course)),
      members_(std::move(members)),
      stream_(course_, std::move(axes), options),
      on_progress_(std::move(on_progress)),
      woken_(executor),
      stopped_(members_.size()) {}

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
    co_await self->drive();
  } catch (...) {
    failure = std::current_exception();
  }
  if (failure) co_await self->stop_all_axes();
  self->leave_axes();
  self->ended_ = true;
  if (failure) std::rethrow_exception(failure);
  self->tell_fault();
  co_return self->stream_.report();
}

void PathRun::pause(bool on) {
  stream_.pause(on);
  woken_.notify();
}

void PathRun::stop(StreamFault why) {
  stream_.stop(std::move(why));
  woken_.notify();
}

awaitable<std::optional<AxisFailure>> PathRun::take_axes() {
  std::vector<std::shared_ptr<GatewayAxis>> axes;
  for (const auto& member : members_) axes.push_back(member.axis);
  auto taken = co_await claim_all(std::move(axes), Mover::path, members_.front().movement.permit);
  if (taken) co_return taken;
  for (auto& member : members_) {
    member.axis->set_path(weak_from_this());
    ++member.axis->bus().streams;
  }
  co_return std::nullopt;
}

void PathRun::leave_axes() {
  for (auto& member : members_) {
    member.axis->set_path({});
    member.axis->release(member.movement.permit);
    --member.axis->bus().streams;
  }
}

awaitable<void> PathRun::drive() {
  while (true) {
    notice_stops();
    tell_progress();
    const auto step = stream_.next(now());
    if (std::holds_alternative<tmcl::plan::StreamEnd>(step)) co_return;
    if (const auto* wait = std::get_if<tmcl::plan::StreamWait>(&step))
      co_await woken_.wait_until(std::min(wait->until, progress_due_));
    if (const auto* command = std::get_if<StreamCommand>(&step)) {
      auto answer = co_await carry_out(*command);
      notice_stops();
      stream_.answered(now(), std::move(answer));
    }
  }
}

void PathRun::notice_stops() {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (!members_[i].movement.objection()) continue;
    stream_.stop({StreamFault::Kind::foreign, i,
                  "{" + std::to_string(i) + "} was stopped by somebody else"});
  }
}

void PathRun::tell_progress() {
  if (now() < progress_due_) return;
  progress_due_ = now() + path_progress_interval;
  on_progress_(*this);
}

void PathRun::tell_fault() const {
  const auto& fault = stream_.report().fault;
  if (!fault || is_before_motion(fault->kind)) return;
  const auto& axis = *members_[fault->axis].axis;
  axis.bus().emit({GatewayEvent::Kind::path_broken, axis.bus().name(),
                   number(axis.address().module), 1 << axis.address().motor,
                   tmcl::plan::with_names(fault->message, axis_names())});
}

awaitable<StreamAnswer> PathRun::carry_out(StreamCommand command) {
  const auto& [axis, movement] = members_[command.axis];
  switch (command.kind) {
    case StreamCommand::Kind::get: {
      const auto read = co_await axis->get(command.parameter, {});
      co_return answer_of(read);
    }
    case StreamCommand::Kind::set: {
      const bool moves = command.parameter == tmcl::axis_parameter::target_position;
      auto options = moves ? movement : RunOptions{};
      options.permit = movement.permit;
      const auto set = co_await axis->write(command.parameter, command.value, std::move(options));
      co_return answer_of(set);
    }
    case StreamCommand::Kind::rotate: {
      auto script = tmcl::verbs::rotate(axis->address(), tmcl::InternalVelocity{command.value});
      const auto turned = co_await axis->perform(std::move(script), movement);
      co_return answer_of(turned);
    }
    case StreamCommand::Kind::move_to: {
      auto script = tmcl::verbs::move_to(axis->address(), tmcl::Microsteps{command.value});
      const auto moved = co_await axis->perform(std::move(script), movement);
      co_return answer_of(moved);
    }
    case StreamCommand::Kind::stop: {
      auto stopped = co_await stop_axis(command.axis);
      co_return stopped;
    }
  }
  co_return 0;
}

// All at once: none waits for one that does not answer.
awaitable<void> PathRun::stop_all_axes() {
  std::vector<awaitable<StreamAnswer>> stops;
  for (const auto& member : members_) stops.push_back(stop_now(member.axis));
  auto answers = co_await gather(std::move(stops));
  for (std::size_t i = 0; i < answers.size(); ++i) stopped_[i] = std::move(answers[i]);
}

awaitable<StreamAnswer> PathRun::stop_axis(std::size_t axis) {
  if (!stopped_[axis]) co_await stop_all_axes();
  auto answer = std::move(*stopped_[axis]);
  stopped_[axis].reset();
  co_return answer;
}

}  // namespace tmcld
