/// Whether a command may go to a motor now, for a call. Decided here and nowhere else.
///
/// judge() is a pure function of the state of the motor, of the intent of the command, of the
/// permit of the call and of the time. A bus asks it when a verb begins, before each request, and
/// once more when the bytes of that go out: see GatewayBus::run(). Its table is in docs/SAFETY.md,
/// drawn by a test.
///
/// A stop and a question are always allowed.
#pragma once

#include <cstdint>
#include <string>

#include "tmcl/clock.hpp"
#include "tmcl/intent.hpp"

namespace tmcld {

/// The right of a call to move motors, from when it came in. Without one nothing moves.
struct Permit {
  std::uint64_t number = 0;         ///< Of the call; 0: none.
  std::uint64_t client = 0;         ///< That made it; 0: none.
  bool exceeds_limits = false;      ///< The limits of axes do not hold for it: see AxisLimits.
  bool needs_lease = false;         ///< It moves only what its client has a lease of.
  bool unattended = false;          ///< What it sets turning turns on when its client goes.
  bool needs_no_reference = false;  ///< It counts from where an axis stands.
  bool ends_with_client = false;    ///< Also what it leads.
  bool only_asks = false;  ///< What it has not asked yet when its client goes, is not asked.
  /// Of one call.
  bool operator==(const Permit& other) const { return number == other.number; }
};

/// What a call does that claims an axis.
enum class ClaimKind : std::uint8_t {
  none,
  line,
  path,
  mint,
  jog,
  approach,
  search,
  deadman_test,
  verification,
  settings,  ///< It stands, and is set.
  stop,      ///< No call, until it is certain that it stands: see standing_stop.hpp.
  tuning,
};

/// What is known of a motor, and of the client of the call that is judged. Calls and stops are
/// numbered in the order in which they came in: see Arrivals.
struct MotorState {
  bool is_axis = false;
  bool is_ending = false;         ///< The daemon.
  std::uint64_t last_stop = 0;    ///< Of this motor, or of all.
  std::uint64_t last_stale = 0;   ///< The last call from before a gap of the reactor.
  tmcl::TimePoint turned_last{};  ///< The reactor; never: it has not begun to.
  ClaimKind claimed_for = ClaimKind::none;
  std::uint64_t claimed_by = 0;  ///< The number of the call.
  std::uint64_t leased_to = 0;   ///< A client; 0: it is not leased.
  std::uint64_t last_loss = 0;   ///< Of a lease.
  std::uint64_t turns_for = 0;   ///< A client, without end; 0: no client.
  bool is_latched = false;
  std::uint64_t searched_by = 0;      ///< A call that may move it although it is latched.
  bool misses_reference = false;      ///< It needs one and has none.
  bool owes_stop = false;             ///< Its module: one was asked for, and not answered.
  bool has_held_coordinates = false;  ///< Its module.
  bool is_client_gone = false;
};

enum class Ruling : std::uint8_t {
  allow,
  ask,  ///< Something first, which may end the obstacle.
  refuse,
};

/// Why a command does not go out now. Of several the first is told that refuses.
enum class Obstacle : std::uint8_t {
  none,
  // Those that refuse.
  claimed,  ///< Another call moves the axis.
  daemon_ends,
  no_call,  ///< No call has asked for it.
  stopped,  ///< The call came in before the last stop.
  stale,    ///< The reactor has stood still since the call came in.
  latched,
  leased,  ///< To another client.
  lease_lost,
  client_gone,
  lease_missing,
  reference_missing,
  // Those that are asked about.
  claimed_by_search,  ///< Which may have ended unseen.
  claimed_by_line,    ///< Which may have ended unseen.
  turns_for_other,    ///< Or stands already.
  stop_owed,
  coordinates_held,
};
constexpr auto last_obstacle = Obstacle::coordinates_held;

struct Verdict {
  Ruling ruling = Ruling::allow;
  Obstacle because = Obstacle::none;
  bool operator==(const Verdict&) const = default;
};

Verdict judge(const MotorState& state, const tmcl::Intent& intent, const Permit& permit,
              tmcl::TimePoint now);
/// Whether the call has still the right to move the motor, whatever it does next. It says nothing
/// of what has to end before.
Verdict judge_right(const MotorState& state, const Permit& permit, tmcl::TimePoint now);

/// Another call moves the axis.
constexpr bool is_claim(Obstacle obstacle) {
  return obstacle == Obstacle::claimed || obstacle == Obstacle::claimed_by_search ||
         obstacle == Obstacle::claimed_by_line;
}

/// The call leads the axis, as on a line or a path. That belongs to the gateway, and not to the
/// client that asked for it.
bool leads(const MotorState& state, const Permit& permit);

}  // namespace tmcld
