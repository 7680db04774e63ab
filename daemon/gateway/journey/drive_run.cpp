#include "gateway/journey/drive_run.hpp"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/rest.hpp"
#include "async/slept.hpp"
#include "async/spawn.hpp"
#include "gateway/standing_stop.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::plan::Drive;
using tmcl::plan::DriveCommand;
using tmcl::plan::DriveCommands;
using tmcl::plan::DriveFault;

// Coordinate 0 is never kept in the EEPROM.
constexpr std::uint8_t scratch_coordinate = 0;

bool is_unstopped(const tmcl::plan::DriveReport* report, std::size_t axis) {
  return report != nullptr &&
         std::ranges::count(report->unstopped, axis, &tmcl::plan::Unstopped::axis) > 0;
}

/// What was not set back, in the order in which it was changed.
std::vector<tmcl::plan::Setting> left_of(const tmcl::plan::DriveReport* report, std::size_t axis) {
  std::vector<tmcl::plan::Setting> left;
  if (report == nullptr) return left;
  for (const auto& unrestored : report->unrestored)
    if (unrestored.axis == axis) left.insert(left.begin(), unrestored.before);
  return left;
}

template <class T>
tmcl::Result<std::int32_t> answer_of(tmcl::Result<T> result) {
  if constexpr (std::is_same_v<T, std::int32_t>) {
    return result;
  } else {
    return std::move(result).map([](auto&&...) { return 0; });
  }
}

}  // namespace

awaitable<void> DriveRun::drive(Drive& drive, std::function<bool()> is_enough) {
  ++drives_;
  co_await enter_journal(*members_.front().axis);
  spawn(co_await boost::asio::this_coro::executor, watch_modules(shared_from_this(), drives_));
  try {
    co_await take_steps(drive, std::move(is_enough));
  } catch (...) {
    broken_ = std::current_exception();
  }
  ++drives_;
  if (!broken_) co_return;
  for (const auto& member : members_) stop_until_it_stands(member.axis);
  std::rethrow_exception(broken_);
}

/// An axis whose module is not what it was is latched, which ends the drive.
awaitable<void> DriveRun::watch_modules(std::shared_ptr<DriveRun> self, std::size_t drive) {
  while (self->drives_ == drive) {
    for (const auto& member : self->members_) {
      const auto axis = member.axis;
      co_await axis->bus().run(axis->module().watch(journey_sentinel_age), RunOptions());
    }
    co_await rest(journey_sentinel_age);
  }
}

awaitable<void> DriveRun::take_steps(Drive& drive, std::function<bool()> is_enough) {
  while (!broken_ && !is_enough()) {
    const auto look_again = co_await before_step();
    notice_stops(drive);
    auto step = drive.next(now());
    if (std::holds_alternative<tmcl::plan::DriveEnd>(step)) co_return;
    if (const auto* wait = std::get_if<tmcl::plan::DriveWait>(&step)) {
      // A wait that is over is a breath of a long computation: others get their turn in it.
      if (wait->until <= now()) co_await boost::asio::post(boost::asio::use_awaitable);
      co_await woken_.wait_until(std::min(wait->until, look_again));
    } else {
      co_await give(drive, std::move(std::get<DriveCommands>(step)));
    }
  }
}

// One alone needs no coroutine of its own.
awaitable<void> DriveRun::give(Drive& drive, DriveCommands commands) {
  if (commands.size() == 1 && under_way_ == 0) {
    co_await answer(drive, commands.front());
    co_return;
  }
  const auto executor = co_await boost::asio::this_coro::executor;
  for (const auto& command : commands) {
    ++under_way_;
    auto answered = [](std::shared_ptr<DriveRun> self, Drive& of,
                       DriveCommand given) -> awaitable<void> {
      co_await self->answer(of, given);
      --self->under_way_;
      self->woken_.notify();
    };
    spawn(executor, answered(shared_from_this(), drive, command));
  }
}

awaitable<void> DriveRun::answer(Drive& drive, DriveCommand command) {
  tmcl::Result<std::int32_t> answer =
      tl::unexpected(tmcl::bad_argument("it could not be carried out"));
  try {
    auto done = co_await carry_out(command);
    answer = std::move(done);
  } catch (...) {
    failure_ = std::current_exception();
  }
  notice_stops(drive);
  if (broken_) co_return;
  try {
    drive.answered(now(), command.axis, std::move(answer));
  } catch (...) {
    broken_ = std::current_exception();
  }
}

// Before the drive judges what it has read: after a gap its axes are where it did not expect them.
void DriveRun::notice_stops(Drive& drive) const {
  const auto& bus = members_.front().axis->bus();
  bus.motors().arrivals()->gaps.look(now(), slept(bus.executor()));
  for (std::size_t i = 0; i < members_.size(); ++i) {
    auto stop = members_[i].movement.objection();
    if (!stop || (stop->code == tmcl::Errc::stale_request && runs_by_itself())) continue;
    const bool is_stop = stop->code == tmcl::Errc::superseded_by_stop;
    auto why = is_stop ? "was stopped by another client" : "";
    drive.stop({DriveFault::Kind::foreign, i, why, std::move(stop), {}});
  }
}

awaitable<std::optional<tmcl::Error>> DriveRun::claim(ClaimOwner claim_owner) {
  std::vector<std::shared_ptr<GatewayAxis>> axes;
  for (const auto& member : members_) axes.push_back(member.axis);
  auto claims = co_await claim_all(std::move(axes), std::move(claim_owner));
  if (!claims) co_return std::move(claims.error());
  claims_ = std::move(*claims);
  co_return std::nullopt;
}

awaitable<void> DriveRun::enter_journal(const GatewayAxis& axis) {
  auto failure = co_await axis.enter_journal();
  if (journal_failure_.empty()) journal_failure_ = std::move(failure);
}

void DriveRun::release(const tmcl::plan::DriveReport* report) {
  std::vector<std::shared_ptr<GatewayAxis>> unfinished;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const auto& axis = members_[i].axis;
    if (!broken_) axis->keep_before(left_of(report, i));
    if (!axis->before().empty() || is_unstopped(report, i)) unfinished.push_back(axis);
  }
  claims_.clear();
  for (const auto& axis : unfinished) stop_until_it_stands(axis);
}

Admitted DriveRun::movement_of(const DriveMember& member) const {
  auto options = *member.admitted;
  options.on_answer = {};
  options.sentinel_age = journey_sentinel_age;
  const auto changed = [this] {
    return std::ranges::find_if(
        members_, [](const auto& one) { return one.admitted->premise.has_changed(); });
  };
  options.premise = {[=, this] { return changed() != members_.end(); },
                     [=] { return changed()->admitted->premise.check(); }};
  options.objection = [this] { return objection(); };
  return options;
}

std::optional<tmcl::Error> DriveRun::objection() const {
  for (const auto& one : members_) {
    if (auto stop = one.movement.objection()) return stop;
  }
  return std::nullopt;
}

awaitable<tmcl::Result<void>> DriveRun::carry_out_word(int /*word*/, bool /*at_stop*/) {
  co_return tmcl::Result<void>{};
}

awaitable<tmcl::Result<std::int32_t>> DriveRun::get(const DriveMember& member,
                                                    DriveCommand command) {
  const auto read = [axis = member.axis, command] { return axis->get(command.parameter, {}); };
  auto reading = command.may_wait ? patience_.insist(read) : read();
  auto value = co_await std::move(reading);
  co_return value;
}

awaitable<tmcl::Result<std::int32_t>> DriveRun::set(const DriveMember& member,
                                                    DriveCommand command) {
  // A module that has started again has the settings that it starts with.
  if (command.may_wait && member.axis->latched()) co_return command.value;
  // As a client wants it that has set it meanwhile.
  const auto wanted = member.axis->before(command.parameter);
  if (command.may_wait && !wanted) co_return command.value;
  if (command.may_wait) command.value = *wanted;
  const bool is_news =
      command.before && member.axis->note_before({command.parameter, *command.before});
  if (is_news) co_await enter_journal(*member.axis);
  const auto once = [this, &member, command] {
    return write(member, {command.parameter, command.value}, command.may_wait);
  };
  auto writing = command.may_wait ? patience_.insist(once) : once();
  auto done = co_await std::move(writing);
  co_return answer_of(std::move(done));
}

awaitable<tmcl::Result<std::int32_t>> DriveRun::carry_out(DriveCommand command) {
  if (command.kind == DriveCommand::Kind::carry_out) {
    auto once = [this, command] { return carry_out_word(command.value, command.may_wait); };
    auto switching = command.may_wait ? patience_.insist(once) : once();
    auto switched = co_await std::move(switching);
    co_return answer_of(std::move(switched));
  }
  const auto& member = members_[command.axis];
  auto movement = movement_of(member);
  const auto address = member.axis->address();
  switch (command.kind) {
    case DriveCommand::Kind::get: {
      auto read = co_await get(member, command);
      co_return read;
    }
    case DriveCommand::Kind::set: {
      auto done = co_await set(member, command);
      co_return done;
    }
    case DriveCommand::Kind::rotate: {
      auto script = tmcl::verbs::rotate(address, tmcl::InternalVelocity{command.value});
      auto turned = co_await member.axis->perform(std::move(script), std::move(movement));
      co_return answer_of(std::move(turned));
    }
    case DriveCommand::Kind::move_to: {
      aim(member, {command.value});
      auto script = tmcl::verbs::move_to(address, tmcl::Microsteps{command.value});
      auto moved = co_await member.axis->perform(std::move(script), std::move(movement));
      co_return answer_of(std::move(moved));
    }
    case DriveCommand::Kind::stop: {
      auto stopping = patience_.insist([this, axis = member.axis] { return stop(*axis); });
      auto stopped = co_await std::move(stopping);
      co_return answer_of(std::move(stopped));
    }
    case DriveCommand::Kind::set_coordinate: {
      const tmcl::Microsteps place{command.value};
      auto script = tmcl::verbs::set_coordinate(address, scratch_coordinate, place);
      auto told = co_await member.axis->perform(std::move(script), std::move(movement));
      co_return answer_of(std::move(told));
    }
    case DriveCommand::Kind::move_motors: {
      const tmcl::MotorMask motors{static_cast<std::uint8_t>(command.value)};
      auto script = tmcl::verbs::move_motors_to_coordinate(
          address.module, motors, tmcl::Together::each_for_itself, scratch_coordinate);
      auto moved = co_await member.axis->perform(std::move(script), std::move(movement));
      co_return answer_of(std::move(moved));
    }
    case DriveCommand::Kind::carry_out: break;  // of no axis
  }
  co_return 0;
}

}  // namespace tmcld
