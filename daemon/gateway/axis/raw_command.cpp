#include "gateway/axis/raw_command.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "tmcl/command_type.hpp"
#include "tmcl/intent.hpp"

namespace tmcld {
namespace {

using tmcl::Command;
namespace ap = tmcl::axis_parameter;

/// The least number of 32 bits has no positive counterpart; no module turns that fast anyway.
std::int32_t opposite(std::int32_t velocity) {
  return -std::max(velocity, -std::numeric_limits<std::int32_t>::max());
}

AxisAction action_of_move(const tmcl::Request& request) {
  switch (request.type) {
    case tmcl::move_type::absolute: return action::MoveTo{{tmcl::Microsteps{request.value}}};
    case tmcl::move_type::relative: return action::MoveFromHere{};
    case tmcl::move_type::coordinate:
      return action::MoveToCoordinate{static_cast<std::uint8_t>(request.value)};
  }
  return action::Restore{ap::target_position};
}

}  // namespace

std::optional<AxisAction> action_of(const tmcl::Request& request) {
  switch (request.command) {
    case Command::MVP: return action_of_move(request);
    case Command::ROR: return action::Turn{{request.value}};
    case Command::ROL: return action::Turn{{opposite(request.value)}};
    case Command::SAP: return action::Write{request.type, request.value};
    case Command::RSAP:
    case Command::AAP: return action::Restore{request.type};
    case Command::MVPA: return action::Restore{ap::target_position};
    case Command::ROLA:
    case Command::RORA: return action::Restore{ap::target_velocity};
    case Command::RFS:
      return starts_search(request) ? std::optional<AxisAction>(action::Search{}) : std::nullopt;
    default: return std::nullopt;
  }
}

bool is_relative_move(const tmcl::Request& request) {
  const auto intent = intent_of(request);
  return intent.motion == tmcl::Motion::by_distance && !intent.is_unseen;
}

tmcl::Script<tmcl::Result<tmcl::Answer>> move_relatively(tmcl::Request request, RelativeMove move) {
  tmcl::CallOptions proven;
  proven.proof = tmcl::Proof::twice;
  const tmcl::Request question{request.address, Command::GAP, move.origin, request.motor, 0};
  auto here = co_await tmcl::exchange(question, proven);
  if (!here) {
    here.error().outcome = tmcl::Outcome::not_sent;
    co_return here;
  }
  const auto target = std::int64_t{here->reply.value} + request.value;
  if (!std::in_range<std::int32_t>(target))
    co_return tl::unexpected(tmcl::bad_argument("it would end outside 32 bits", "move less far"));
  auto absolute = request;
  absolute.type = tmcl::move_type::absolute;
  absolute.value = static_cast<std::int32_t>(target);
  if (move.aim) move.aim(tmcl::Microsteps{absolute.value});
  auto answer = co_await tmcl::exchange(absolute);
  if (!answer) co_return answer;
  const bool tells_target = move.answer == tmcl::RelativeAnswer::target;
  answer->reply.value = tells_target ? absolute.value : request.value;
  co_return answer;
}

bool is_move_to_coordinate(const tmcl::Request& request) {
  return request.command == Command::MVP && request.type == tmcl::move_type::coordinate &&
         intent_of(request).subject == tmcl::Subject::motor;
}

tmcl::Script<tmcl::Result<tmcl::Answer>> move_to_read_coordinate(
    tmcl::Request request, std::function<void(tmcl::Microsteps target)> aim) {
  tmcl::CallOptions proven;
  proven.proof = tmcl::Proof::twice;
  const auto coordinate = static_cast<std::uint8_t>(request.value);
  const tmcl::Request question{request.address, Command::GCO, coordinate, request.motor, 0};
  auto place = co_await tmcl::exchange(question, proven);
  if (!place) {
    place.error().outcome = tmcl::Outcome::not_sent;
    co_return place;
  }
  auto absolute = request;
  absolute.type = tmcl::move_type::absolute;
  absolute.value = place->reply.value;
  aim(tmcl::Microsteps{absolute.value});
  auto answer = co_await tmcl::exchange(absolute);
  if (answer) answer->reply.value = request.value;
  co_return answer;
}

}  // namespace tmcld
