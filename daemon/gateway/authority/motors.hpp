/// What is known of the motors of a bus: stops, leases, claims, latches, references, and what turns
/// without end. Whether a request may go out is judged by it: see judge.hpp.
///
/// Calls and stops are numbered in the order in which they come in, over all buses, and a stop
/// leaves its number with the motors that it is for. A request goes out only for a call that came
/// in behind the last stop of each motor that it can move: however late the call comes to send it.
///
/// An axis whose module is not what it was is latched: nothing moves it until a search of its
/// reference or a person clears it.
///
/// A call that moves an axis on a line, on a path or in a reference search claims it, and no other
/// call moves it meanwhile. Only the holder of a lease of a motor may move it, and change what
/// its module is set to. A stop needs no permit and heeds neither.
///
/// The client that sets an axis turning without end owns that until the axis is seen to stand, or a
/// command has surely ended it: see tmcl/intent.hpp. It is stopped when its owner goes.
///
/// Does no I/O. Thread safety: none. What it holds is bounded by the number of axes, by
/// most_other_motors, and by how many requests a bus takes.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "gateway/authority/gaps.hpp"
#include "gateway/authority/judge.hpp"
#include "tmcl/address.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/error.hpp"
#include "tmcl/intent.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/model.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

class AwaitedRun;

/// In which order calls and stops came in, and who is there: one for all buses.
struct Arrivals {
  std::uint64_t last = 0;
  std::uint64_t stop_of_all = 0;
  bool closing = false;                            ///< Nothing is set in motion any more.
  std::map<std::uint64_t, std::string> clients{};  ///< With what people call them.
  std::uint64_t last_client = 0;
  Gaps gaps{};

  Permit admit(std::uint64_t client = 0) { return {++last, client}; }
  void stop_all() { stop_of_all = ++last; }
  bool is_there(std::uint64_t client) const { return client == 0 || clients.contains(client); }
  /// For an answer: at the end of the daemon clients move nothing any more, but they still wait.
  bool waits(std::uint64_t client) const { return closing || is_there(client); }
};

tmcl::Error client_gone();

/// Who alone may move a motor.
struct Holder {
  std::uint64_t client = 0;  ///< 0: there is none.
  std::int32_t lease = 0;    ///< 0: there is none.
  std::string name{};        ///< Of the client, for people.
};

/// A motor turns without end, or may: until it is seen to stand, or a command has surely ended it.
struct Turning {
  std::uint64_t number = 0;  ///< Of all turnings; 0: it does not turn.
  std::uint64_t client = 0;  ///< Its owner, with whom it ends; 0: it is unattended.
  std::string name{};        ///< Of the owner, for people.
};

/// Where the last command that moved or stopped a motor has sent it.
enum class Sent : std::uint8_t {
  unseen,       ///< Not known: a program or another host may have sent it anywhere.
  elsewhere,    ///< To no position: it was stopped, or turns, or searches.
  to_position,  ///< To where it is to stand.
};

struct ClaimOwner {
  ClaimKind by = ClaimKind::none;
  Permit of{};                          ///< The call that has begun it.
  std::weak_ptr<AwaitedRun> journey{};  ///< Whose end a client waits for.
  bool operator==(const ClaimOwner& other) const { return by == other.by && of == other.of; }
};

/// In the modes below that of velocity an axis goes to its target; in the one above it keeps the
/// speed that it was given.
constexpr bool may_turn_in(const tmcl::ModeParameter& mode, std::int32_t value) {
  return value >= mode.velocity;
}

class Motors;

/// A call waits for so long for a line or path that is over, to move one of its axes: it may still
/// be about to give its axes their settings back.
inline constexpr tmcl::Duration time_to_be_free = std::chrono::seconds(2);

/// Only one call moves a motor, for as long as this lives. Must not outlive the Motors it is of.
class Claim {
  friend class Motors;
  struct Release {
    tmcl::AxisAddress motor{};
    Permit of{};
    void operator()(Motors* motors) const;
  };
  Claim(Motors& motors, tmcl::AxisAddress motor, Permit of) : held_(&motors, Release{motor, of}) {}

  std::unique_ptr<Motors, Release> held_;
};

/// A command is on its way that may set a motor turning. Must not outlive the Motors it is of.
class TurningAttempt {
 public:
  TurningAttempt() = default;
  /// There is one.
  explicit operator bool() const { return held_ != nullptr; }
  /// It was not sent, or its module refused it: the motor does what it did before.
  void withdraw();

 private:
  friend class Motors;
  struct End {
    tmcl::AxisAddress motor;
    void operator()(Motors* motors) const;
  };
  TurningAttempt(Motors& motors, tmcl::AxisAddress motor, Turning before)
      : held_(&motors, End{motor}), before_(std::move(before)) {}

  std::unique_ptr<Motors, End> held_;
  Turning before_;
  std::uint64_t number_ = 0;
};

/// Counts modules, each for as long as its mark lives. Must outlive its marks.
class ModuleMarks {
  struct End {
    tmcl::ModuleAddress module;
    void operator()(ModuleMarks* marks) const;
  };

 public:
  using Mark = std::unique_ptr<ModuleMarks, End>;

  [[nodiscard]] Mark set(tmcl::ModuleAddress module);
  bool has(tmcl::ModuleAddress module) const { return counts_.contains(module); }

 private:
  std::map<tmcl::ModuleAddress, int> counts_;
};
class Motors {
 public:
  /// Motors without an axis, of which the last stop is known. When there are more,
  /// all of them count as stopped now.
  static constexpr std::size_t most_other_motors = 256;

  Motors(std::string bus, std::shared_ptr<Arrivals> arrivals)
      : bus_(std::move(bus)), arrivals_(std::move(arrivals)) {}

  /// Its gaps are looked for before judge(): what was asked for before the reactor stood still is
  /// stale.
  const std::shared_ptr<Arrivals>& arrivals() const { return arrivals_; }

  /// There is an axis: it can be claimed.
  void add(tmcl::AxisAddress motor, const std::string& axis, bool needs_reference = false);

  /// Calls that came in before this have no right to move the motor any more.
  void stop(tmcl::AxisAddress motor);
  /// The number of the last one, among calls and stops; 0: there was none.
  std::uint64_t last_stop_of(tmcl::AxisAddress motor) const {
    return state_of(motor, {}).last_stop;
  }
  /// The strictest verdict on what a request concerns, and the motor that it is about.
  struct Judgement {
    Verdict verdict{};
    tmcl::AxisAddress motor{};
    bool operator==(const Judgement&) const = default;
  };
  /// May the request go out now, for the call? `owes_stop`: its module.
  Judgement judge(const tmcl::Request& request, Permit permit, tmcl::TimePoint now,
                  bool owes_stop = false) const;
  /// Why the call has no right any more to move the motor: see judge_right().
  std::optional<tmcl::Error> objection(tmcl::AxisAddress motor, Permit permit,
                                       tmcl::TimePoint now) const;
  /// The error for a request that does not go out.
  tmcl::Error refusal(tmcl::AxisAddress motor, Obstacle because) const;

  /// No other client moves the motor from now on; without a client, any may.
  void lease(tmcl::AxisAddress motor, Holder holder);
  /// The same; and calls that came in before this have no right to move it any more, but for those
  /// that lead it along a line or path.
  void lose_lease(tmcl::AxisAddress motor);
  /// With client 0 if it has none. Without a lease: the owner of its turning.
  Holder holder_of(tmcl::AxisAddress motor) const;

  /// The client of the call owns what it sets turning, from now on: before that is sent. None of
  /// motors whose holder is another client.
  [[nodiscard]] std::vector<TurningAttempt> begin_turning(const std::set<tmcl::AxisAddress>& motors,
                                                          Permit of);
  /// It was found turning, and no client owns that.
  void note_unattended(tmcl::AxisAddress motor);
  Turning turning_of(tmcl::AxisAddress motor) const;
  /// A command is on its way that may set it turning.
  bool is_to_turn(tmcl::AxisAddress motor) const {
    const auto found = motors_.find(motor);
    return found != motors_.end() && found->second.turning_attempts > 0;
  }
  /// It was seen to stand. Nothing happens while a command is on its way that may set it turning.
  /// `number`: of the turning that was known before it was looked at.
  void end_turning(tmcl::AxisAddress motor, std::uint64_t number);
  struct Coordinates {
    /// Modules whose coordinates were checked, and stay what they are until a move to them is sent.
    ModuleMarks holds{};
    /// Modules to which something is on its way that changes their coordinates.
    ModuleMarks changes{};
  };
  Coordinates& coordinates() { return coordinates_; }

  /// Nothing moves the axes of a module any more, and they have lost their reference. Whatever
  /// moves them on a line or path is woken, to find that out. `cause`: a sentence without a full
  /// stop.
  void latch(tmcl::ModuleAddress module, const std::string& cause);
  /// The axis is cleared: of what was known when it had been latched so many times.
  void recover(tmcl::AxisAddress motor, std::uint64_t latches);
  std::uint64_t latches(tmcl::AxisAddress motor) const;
  /// The call may move the axis all the same: it searches its reference. When that has begun, the
  /// axis is latched no more.
  void let_search(tmcl::AxisAddress motor, Permit permit);
  /// Why nothing moves the axis; nothing if it may be moved.
  std::optional<tmcl::Error> latched(tmcl::AxisAddress motor) const;
  /// Its positions mean something: it has found its reference, or has been told where it is, and
  /// its module has not started again since.
  bool is_referenced(tmcl::AxisAddress motor) const;
  void set_referenced(tmcl::AxisAddress motor, bool is_referenced = true);
  /// The motor of an axis that is not claimed.
  [[nodiscard]] Claim claim(tmcl::AxisAddress motor, ClaimOwner claim_owner);
  /// Nothing happens if the call has not claimed it.
  void release(tmcl::AxisAddress motor, Permit of);
  ClaimOwner claim_owner_of(tmcl::AxisAddress motor) const;
  /// How many motors are claimed like this.
  std::ptrdiff_t claimed_by(ClaimKind by) const;
  /// A request that can move a motor is on its way, from begin() to end(): in the queue of the bus
  /// perhaps. A search claims the motor that it moves.
  void begin(const tmcl::Request& request, Permit of);
  void end(const tmcl::Request& request);
  /// Motors without an axis that requests have moved since they were stopped, or can move that are
  /// on their way. Of those that have moved, most_other_motors are known.
  std::set<tmcl::AxisAddress> others_that_may_move() const;
  /// Calls the function for each motor that is known, first for those that may move. Takes no
  /// memory.
  template <class Does>
  void for_each(Does does) const {
    for (const auto motor : moved_) does(motor);
    for (const bool may : {true, false}) {
      for (const auto& [address, motor] : motors_)
        if (!moved_.contains(address) && may_move(address) == may) does(address);
    }
  }
  /// As far as is known: something that can move it has gone out since it was stopped last.
  bool may_move(tmcl::AxisAddress motor) const;
  /// Names of the axes that are led, that search, or that were told to turn, as far as is known.
  std::vector<std::string> under_way() const;
  /// What moved or stopped it last was sent from here, and says where it is to stand.
  bool was_sent_to_position(tmcl::AxisAddress motor) const;
  /// A program was started in the module, and none was stopped since: it may move any motor.
  bool may_run_program(tmcl::ModuleAddress module) const { return programs_.contains(module); }

  /// How it was before a request was sent.
  struct Before {
    ClaimOwner claim_owner{};
    std::uint64_t turnings = 0;  ///< The number of the last one.
    Permit of{};
    std::set<tmcl::AxisAddress> turned{};  ///< By the request.
  };
  Before before(const tmcl::Request& request, Permit of, const tmcl::Model* model) const {
    return {claim_owner_of({request.address, request.motor}), last_turning_, of,
            tmcl::motors_turned_by(request, model)};
  }
  /// Learns from what goes past whether reference searches run, and what turns.
  void note(const tmcl::Request& request, const tmcl::Result<tmcl::Answer>& answer,
            const Before& before);

 private:
  friend class TurningAttempt;
  struct Motor {
    std::string axis{};  ///< Empty where there is none.
    std::uint64_t last_stop = 0;
    std::uint64_t last_loss = 0;  ///< Of a lease.
    ClaimOwner claim_owner{};
    Holder holder{};  ///< By a lease.
    Turning turning{};
    int turning_attempts = 0;   ///< On their way.
    std::string latch_cause{};  ///< Empty: it is not latched.
    std::uint64_t latches = 0;  ///< How many times it was.
    Permit searcher{};          ///< Who may move it all the same.
    bool is_referenced = false;
    bool needs_reference = false;
    Sent sent = Sent::unseen;
  };

  bool is_axis(tmcl::AxisAddress motor) const;
  void note_claim(tmcl::AxisAddress motor, ClaimOwner claim_owner);
  void forget_other_motors();
  void note_moved(const tmcl::Request& request);
  void note_target(const tmcl::Request& request, const Before& before);
  void note_program(const tmcl::Request& request, bool is_done);
  TurningAttempt begin_turning(tmcl::AxisAddress motor, Permit of);
  MotorState state_of(tmcl::AxisAddress motor, Permit permit) const;
  void note_turning(const tmcl::Request& request, bool is_done, const Before& before);
  void turn(Motor& motor, Permit of);
  bool is_led_by(tmcl::AxisAddress motor, Permit permit) const;
  tmcl::Error error(tmcl::Errc code, std::string message, std::string hint) const;

  std::string bus_;
  std::shared_ptr<Arrivals> arrivals_;
  std::map<tmcl::AxisAddress, Motor> motors_;
  std::vector<tmcl::Request> on_their_way_;
  std::uint64_t last_turning_ = 0;
  std::set<tmcl::ModuleAddress> programs_;
  Coordinates coordinates_;
  std::set<tmcl::AxisAddress> moved_;  ///< Since they were stopped; axes and others.
  /// Of motors that are not in the map, it is not known any better.
  std::uint64_t last_stop_of_others_ = 0;
};

}  // namespace tmcld
