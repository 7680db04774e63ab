#include "gateway/path_run.hpp"

#include <algorithm>
#include <exception>
#include <set>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/gather.hpp"
#include "async/rest.hpp"
#include "tmcl/plan/path_run.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using std::chrono::milliseconds;
using tmcl::plan::PathStream;
using tmcl::plan::StreamAnswer;
using tmcl::plan::StreamCommand;
using tmcl::plan::StreamFault;

// A log has one line for it.
std::string in_one_line(tmcl::Error error) {
  const auto hint = std::exchange(error.hint, {});
  return describe(error) + (hint.empty() ? "" : "; " + hint);
}

template <class T>
StreamAnswer answer_of(const tmcl::Result<T>& result) {
  if (!result) return tl::unexpected(in_one_line(result.error()));
  if constexpr (std::is_same_v<T, std::int32_t>) {
    return *result;
  } else {
    return 0;
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
  if (failure) co_await self->stop_axis(0);  // all of them
  self->leave_axes();
  for (const auto axis : self->stream_.report().unstopped)
    stop_as_soon_as_possible(self->members_[axis].axis, GatewayEvent::Kind::path_broken);
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
    if (const auto* wait = std::get_if<tmcl::plan::StreamWait>(&step)) {
      // A wait that is over is a breath of a long computation: others get their turn in it.
      if (wait->until <= now()) co_await boost::asio::post(boost::asio::use_awaitable);
      co_await woken_.wait_until(std::min(wait->until, progress_due_));
    }
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
  axis.bus().emit(event_of(axis, GatewayEvent::Kind::path_broken, text_of(*fault)));
}

std::string PathRun::text_of(const StreamFault& fault) const {
  auto text = tmcl::plan::with_names(fault.message, axis_names());
  for (const auto& axis : unstopped()) text += "; " + not_stopped(axis);
  return text;
}

std::vector<std::string> PathRun::unstopped() const {
  const auto names = axis_names();
  std::vector<std::string> unstopped;
  for (const auto axis : stream_.report().unstopped) unstopped.push_back(names[axis]);
  return unstopped;
}

// What may be done twice waits for a link that was lost: a parameter that is set back, and after
// the first stop, readings. Before it, no reading does: a stop is to follow at once.
bool PathRun::may_wait_for_link(const StreamCommand& command) const {
  const bool sets_back =
      command.kind == StreamCommand::Kind::set && stream_.phase() == PathStream::Phase::after;
  return sets_back || (stopping_ && command.kind == StreamCommand::Kind::get);
}

awaitable<StreamAnswer> PathRun::carry_out(StreamCommand command) {
  const auto& [axis, movement] = members_[command.axis];
  const bool patient = may_wait_for_link(command);
  switch (command.kind) {
    case StreamCommand::Kind::get: {
      const auto get = [axis = axis, command] { return axis->get(command.parameter, {}); };
      auto reading = patient ? patience_.insist(get) : get();
      const auto read = co_await std::move(reading);
      co_return answer_of(read);
    }
    case StreamCommand::Kind::set: {
      const bool moves = command.parameter == tmcl::axis_parameter::target_position;
      auto options = moves ? movement : RunOptions{};
      options.permit = movement.permit;
      const auto set = [axis = axis, command, options] {
        return axis->write(command.parameter, command.value, options);
      };
      auto writing = patient ? patience_.insist(set) : set();
      const auto done = co_await std::move(writing);
      co_return answer_of(done);
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
awaitable<StreamAnswer> PathRun::stop_axis(std::size_t axis) {
  if (!stopped_[axis]) {
    stopping_ = true;
    std::vector<awaitable<tmcl::Result<void>>> stops;
    for (const auto& member : members_)
      stops.push_back(patience_.insist([axis = member.axis] { return axis->brake(); }));
    const auto results = co_await gather(std::move(stops));
    for (std::size_t i = 0; i < results.size(); ++i) stopped_[i] = answer_of(results[i]);
  }
  auto answer = std::move(*stopped_[axis]);
  stopped_[axis].reset();
  co_return answer;
}

}  // namespace tmcld
