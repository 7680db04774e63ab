// What stands in the way of a command may have ended unseen: the module is asked.
#include "gateway/authority/gate.hpp"

#include <algorithm>

#include "async/slept.hpp"
#include "gateway/authority/search_questions.hpp"
#include "gateway/bus.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

constexpr tmcl::Duration claim_look_interval = std::chrono::milliseconds(5);
constexpr tmcl::Duration coordinate_look_interval = std::chrono::milliseconds(1);

tmcl::Script<bool> has_arrived(tmcl::AxisAddress motor) {
  const auto state = co_await tmcl::verbs::state(motor);
  co_return state && state->velocity.value == 0 && state->position == state->target;
}

}  // namespace

Motors::Judgement Gate::judge(const tmcl::Request& request, Permit permit) const {
  return motors_.judge(request, permit, bus_.clock().now(), owes_stop(request.address));
}

void Gate::look_for_gap() const {
  motors_.arrivals()->gaps.look(bus_.clock().now(), slept(bus_.executor()));
}

Gate::Script<void> Gate::may_send(tmcl::Request request, Permit permit, Asks asks) {
  std::optional<Motors::Judgement> asked;
  while (true) {
    look_for_gap();
    const auto it = judge(request, permit);
    if (it.verdict.ruling == Ruling::allow) co_return tmcl::Result<void>{};
    // What was asked about, and has not ended, refuses.
    const bool may_ask = asks == Asks::what_may_have_ended && it != asked;
    if (it.verdict.ruling == Ruling::refuse || !may_ask)
      co_return tl::unexpected(motors_.refusal(it.motor, it.verdict.because));
    asked = it;
    co_await must(ask_about(it));
  }
}

/// Another call can see an axis at the end of its line before the line does.
Gate::Script<void> Gate::see_end_of_line(tmcl::AxisAddress motor) {
  const auto claim_owner = motors_.claim_owner_of(motor);
  const bool ends = co_await has_arrived(motor);
  const auto looks = ends ? time_to_be_free / claim_look_interval : 0;
  for (auto i = looks; i > 0 && motors_.claim_owner_of(motor) == claim_owner; --i)
    co_await tmcl::pause(claim_look_interval);
  co_return tmcl::Result<void>{};
}

/// What cannot be seen to stand turns on, as far as is known.
Gate::Script<void> Gate::look_whether_it_turns(tmcl::AxisAddress motor) {
  co_await see_turning_end(motor);
  co_return tmcl::Result<void>{};
}

Gate::Script<void> Gate::see_coordinates_released(tmcl::ModuleAddress module) {
  while (motors_.coordinates().holds.has(module)) co_await tmcl::pause(coordinate_look_interval);
  co_return tmcl::Result<void>{};
}

Gate::Script<void> Gate::ask_about(Motors::Judgement it) {
  switch (it.verdict.because) {
    case Obstacle::claimed_by_search: return see_search_end(it.motor);
    case Obstacle::claimed_by_line: return see_end_of_line(it.motor);
    case Obstacle::turns_for_other: return look_whether_it_turns(it.motor);
    case Obstacle::stop_owed: return pay_stops(it.motor.module);
    default: return see_coordinates_released(it.motor.module);
  }
}

std::vector<tmcl::step::Exchange> questions_about_search(tmcl::AxisAddress motor) {
  const auto ask = [&](tmcl::Command command, std::uint8_t type) {
    tmcl::step::Exchange question{{motor.module, command, type, motor.motor, 0}, {}};
    question.options.proof = tmcl::Proof::followed;
    return question;
  };
  return {ask(tmcl::Command::RFS, tmcl::search_type::status),
          ask(tmcl::Command::GAP, tmcl::axis_parameter::actual_velocity),
          ask(tmcl::Command::GAP, tmcl::axis_parameter::actual_position)};
}

/// A status does not say how a search has ended. One that has found its reference has made that
/// zero, and the axis stands there. Flags tell nothing: a search for a stall ends with one, too.
/// A module that cannot tell whether it searches locks no client out.
Gate::Script<void> Gate::see_search_end(tmcl::AxisAddress motor) {
  const auto claim_owner = motors_.claim_owner_of(motor);
  const auto answers = co_await exchange_all(questions_about_search(motor));
  for (const auto& answer : answers) {
    if (answer || answer.error().outcome == tmcl::Outcome::refused) continue;
    auto error = answer.error();
    error.outcome = tmcl::Outcome::not_sent;
    co_return tl::unexpected(std::move(error));
  }
  if (motors_.claim_owner_of(motor) != claim_owner) co_return tmcl::Result<void>{};
  const auto& status = answers.front();
  if (status && status->reply.value != 0)
    co_return tl::unexpected(motors_.refusal(motor, Obstacle::claimed_by_search));
  const auto is_zero = [](const auto& answer) { return answer && answer->reply.value == 0; };
  if (std::ranges::all_of(answers, is_zero)) motors_.set_referenced(motor);
  motors_.release(motor, claim_owner.of);
  co_return tmcl::Result<void>{};
}

// ---- turning without end -----------------------------------------------------------------------

namespace {

std::optional<tmcl::ModeParameter> mode_of(const tmcl::Model* model) {
  if (model == nullptr) return std::nullopt;
  return tmcl::mode_parameter(tmcl::axis_parameters(*model));
}

std::vector<tmcl::step::Exchange> questions_about_turning(
    tmcl::AxisAddress motor, const std::optional<tmcl::ModeParameter>& mode) {
  std::vector<std::uint8_t> parameters{tmcl::axis_parameter::actual_velocity,
                                       tmcl::axis_parameter::target_velocity};
  if (mode) parameters.push_back(mode->number);
  std::vector<tmcl::step::Exchange> questions;
  for (const auto parameter : parameters) {
    questions.push_back({{motor.module, tmcl::Command::GAP, parameter, motor.motor, 0}, {}});
    questions.back().options.proof = tmcl::Proof::twice;
  }
  return questions;
}

}  // namespace

Gate::Script<bool> Gate::may_turn(tmcl::AxisAddress motor) {
  const auto mode = mode_of(bus_.model_of(motor.module));
  auto questions = questions_about_turning(motor, mode);
  const auto answers = co_await exchange_all(std::move(questions));
  for (const auto& answer : answers) {
    if (!answer && answer.error().outcome != tmcl::Outcome::refused)
      co_return tl::unexpected(answer.error());
  }
  const auto& told = answers.back();
  if (mode && told && !may_turn_in(*mode, told->reply.value)) co_return false;
  // A module that does not tell what it is to do is judged by what it does.
  const auto is_zero = [](const auto& answer) { return !answer || answer->reply.value == 0; };
  co_return !is_zero(answers[0]) || !is_zero(answers[1]);
}

Gate::Script<void> Gate::see_turning_end(tmcl::AxisAddress motor) {
  const auto turning = motors_.turning_of(motor);
  // What is on its way may set it turning after it was looked at.
  if (turning.number == 0 || motors_.is_to_turn(motor)) co_return tmcl::Result<void>{};
  const auto turns = co_await may_turn(motor);
  if (!turns) co_return tl::unexpected(turns.error());
  if (!*turns) motors_.end_turning(motor, turning.number);
  co_return tmcl::Result<void>{};
}

Gate::Script<void> Gate::hold_still(tmcl::ModuleAddress module) {
  while (motors_.coordinates().changes.has(module)) co_await tmcl::pause(coordinate_look_interval);
  co_return tmcl::Result<void>{};
}

}  // namespace tmcld
