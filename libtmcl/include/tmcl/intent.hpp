/// What a request can do: what it makes of how motors move, and of which.
///
/// The table of commands (tmcl/command.hpp) has it for each command, and for each type that differs
/// from its command; a request says the rest by its motor, its value and the model of its module.
/// Whatever must know what a request does asks here: the queue of a bus, and in the daemon the
/// judgement of a movement, limits, roles and leases. So no two of them can disagree.
///
/// A command that TMCL does not define has the strictest intent: it may move every motor of its
/// module and set anything.
///
/// Does no I/O.
#pragma once

#include <cstdint>
#include <set>

namespace tmcl {

struct AxisAddress;
struct Model;
struct Request;

/// What a command can do to the machine behind the module.
enum class Effect : std::uint8_t {
  reads,   ///< Changes nothing.
  writes,  ///< Changes a state that does not move a motor by itself.
  moves,   ///< Can start, prolong or redirect a movement.
  stops,   ///< Ends a movement: goes out before everything else.
};

/// How a motor moves once its module has taken the command.
enum class Motion : std::uint8_t {
  unchanged,     ///< As before.
  to_position,   ///< To a position, whatever it did before.
  by_distance,   ///< Over a distance.
  to_target,     ///< To a position, unless it turns by velocity.
  turns,         ///< Without end, or it may.
  stops,         ///< It comes to stand.
  searches,      ///< In search of its reference.
  by_program,    ///< As a stand-alone program moves it.
  ends_program,  ///< As before, and no stand-alone program moves it any more.
  restarts,      ///< As its module does that starts again, or has left its firmware.
  unforeseen,    ///< No document says how.
};

/// What a value becomes that a command sets.
enum class Setpoint : std::uint8_t {
  none,      ///< Nothing that a motor follows.
  position,  ///< Where it goes.
  velocity,  ///< How fast it turns without end.
  here,      ///< Where it is: it goes on to the target that its module holds.
  mode,      ///< It goes to the target, or turns at the velocity, that its module holds.
};

/// Which motors a command is about. A command that only reads is about none.
enum class Subject : std::uint8_t {
  motor,    ///< The one in its motor field.
  several,  ///< Those of the mask in its motor field.
  chip,     ///< Those that have registers in the chip that it names.
  module,   ///< It names none, so it may concern each of the module.
  output,   ///< None: an output.
};

struct Intent {
  Effect effect = Effect::moves;
  Motion motion = Motion::unforeseen;
  Subject subject = Subject::module;
  Setpoint sets = Setpoint::none;
  /// The value comes from an accumulator or the EEPROM, or goes past the firmware: no host sees
  /// it.
  bool is_unseen = true;
  /// What the module remembers as coordinates may be something else then.
  bool changes_coordinates = true;
  bool operator==(const Intent&) const = default;
};

/// `model`: null where it is not known.
Intent intent_of(const Request& request, const Model* model = nullptr);

/// To a position that the module or the request names.
constexpr bool goes_to_position(Motion motion) {
  return motion == Motion::to_position || motion == Motion::to_target;
}
/// No host knows to where.
constexpr bool is_unpredictable(Motion motion) {
  return motion == Motion::by_program || motion == Motion::unforeseen;
}

/// It ends what moves a motor, and starts nothing.
constexpr bool is_stop(const Intent& intent) {
  return intent.effect == Effect::stops || intent.motion == Motion::ends_program;
}

/// It can start, prolong or redirect a movement: now, or when the module starts again.
bool can_move(const Request& request);
/// The same, of this motor.
bool can_move(const Request& request, AxisAddress motor);
bool starts_search(const Request& request);
/// What it changes can matter to the motor: of commands that name no motor, everything does.
bool concerns(const Request& request, AxisAddress motor, const Model* model = nullptr);
/// The motors that it is about; motor 0 for those that name none, for a stop of any motor of the
/// module ends what they do.
std::set<AxisAddress> motors_of(const Request& request);
/// Which motors it may set turning without end, of those that the module has.
std::set<AxisAddress> motors_turned_by(const Request& request, const Model* model);

}  // namespace tmcl
