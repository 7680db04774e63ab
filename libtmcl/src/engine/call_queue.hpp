/// The calls that wait for their turn on a bus, by kind: stops, whatever acts, reads; each in the
/// order of arrival. Each kind has room of its own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <vector>

#include "tmcl/bus_options.hpp"
#include "tmcl/script.hpp"

namespace tmcl::engine {

/// Names a call to its submitter, which chooses it; never reused while the call
/// lives.
using Ticket = std::uint64_t;

using SharedHold = std::shared_ptr<const Hold>;

/// One that waits for the exchange of another call.
struct Joined {
  Ticket ticket = 0;
  std::uint64_t asker = 0;
  std::function<std::optional<Error>()> objection{};
};

struct Call {
  Request request;
  CallOptions options;
  Ticket ticket = 0;
  /// Who else waits for this exchange: identical reads are joined.
  std::vector<Joined> joined{};
  unsigned times_sent = 0;
  /// A stop that already went out once, unproven, because the line was not in step.
  bool sent_early = false;
  /// A stop that was not answered, as often as it was sent: see ascii_mode.cpp.
  enum class Rescue : std::uint8_t { none, due, tried };
  Rescue rescue = Rescue::none;
  /// Grows with every call that comes in: their order within a level.
  std::uint64_t place = 0;
  /// Since then the link has taken nothing at all.
  std::optional<TimePoint> refused_since{};
  /// The answer, where it could belong to another request until a fence is answered after it.
  std::optional<Answer> unproven{};
  /// Another reply came besides `unproven`.
  bool is_doubtful = false;
  unsigned doubts = 0;  ///< How often that was so.
  /// The answer took long, so it may well be an older one.
  bool was_slow = false;
  /// What came when it was read before, where reading it once is not enough.
  std::optional<Answer> before{};
  std::optional<std::int32_t> last_value{};  ///< The same, also if another reply came since then.
  TimePoint read{};                          ///< When `unproven` came.
  TimePoint last_read{};                     ///< When `last_value` did.
  struct Change {
    double by = 0;
    Duration in{};
  };
  Change change{};  ///< From the reading before that.
  unsigned readings = 0;

  /// A line of a program does nothing now, whatever it will do when the program runs.
  Effect effect =
      options.is_program_line ? Effect::writes : effect_of(request.command, request.type);

  bool is_stop() const { return effect == Effect::stops; }
  bool was_on_the_wire() const { return sent_early || times_sent > 0; }
  bool may_repeat() const {
    return !options.is_program_line && repeat_rule(request.command, request.type) == Repeat::safe;
  }
};

/// Whether a stop makes this queued call pointless, or dangerous.
bool is_ended_by(const Request& stop, const Call& call);

class CallQueue {
 public:
  static constexpr std::size_t kinds = 3;
  /// 0: stops, 1: whatever acts, 2: reads.
  static std::size_t kind_of(const Call& call);

  std::size_t size() const;
  bool has_room_for(const Call& call) const {
    return levels_[kind_of(call)].size() < max_queued_calls;
  }

  void push_back(Call call);
  /// Puts a call that went out, or should have, back to where it was.
  void put_back(Call call);
  /// Lets its ticket wait for an identical read or stop that is queued already. False if there is
  /// none.
  bool join(const Call& newcomer);

  /// The first call, in the order of going out, that satisfies `wanted`; null if none does.
  template <class Wanted>
  Call* find(const Wanted& wanted) {
    for (auto& level : levels_) {
      const auto found = std::ranges::find_if(level, wanted);
      if (found != level.end()) return &*found;
    }
    return nullptr;
  }
  template <class Act>
  void for_each(const Act& act) {
    for (auto& level : levels_) std::ranges::for_each(level, act);
  }
  /// Removes the call that find() gave.
  Call take(const Call& found);
  /// The submitter of the call does not wait any more: the next of those that joined it does. False
  /// if there is none.
  static bool pass_on(Call& call);
  /// Removes every call that satisfies `doomed`, in the order of going out.
  template <class Doomed>
  std::vector<Call> remove_if(const Doomed& doomed) {
    std::vector<Call> removed;
    while (const auto* call = find(doomed)) removed.push_back(take(*call));
    return removed;
  }

  /// The earliest deadline that a queued call has.
  std::optional<TimePoint> earliest_deadline() const;

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  using Calls = std::list<Call>;
  Calls& level_of(const Call& call) { return levels_[kind_of(call)]; }
  void insert(Calls& level, Calls::const_iterator before, Call call);

  std::array<Calls, kinds> levels_;
  /// Room of calls that are gone, for those that come.
  Calls spare_;
  std::uint64_t next_place_ = 0;
};

}  // namespace tmcl::engine
