// The smallest fault that gives a question the answer to another: every way in which a line can
// treat the first datagrams of up to three requests is tried.
//
// TMCL_DEPTH is how many datagrams have a choice (9), TMCL_FAULTS how many of them go wrong at most
// (3). What comes after is delivered. .ci/run lets all nine go wrong, .ci/nightly twelve.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "engine/bus_engine.hpp"
#include "property/engine_state.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;

enum class Kind : std::uint8_t { read, read_followed, read_twice, write, move, stop };
constexpr std::size_t kinds = 6;
constexpr std::size_t most_requests = 3;
constexpr std::array names{
    "a read", "a read that is followed", "a read that is made twice", "a write", "a movement",
    "a stop"};
enum class Fate : std::uint8_t { delivered, lost, late, doubled };

constexpr Duration to_answer = 1ms;
constexpr Duration second_later = 500us;
constexpr Duration too_late = 150ms;

unsigned setting(const char* name, unsigned usual) {
  const char* text = std::getenv(name);
  return text == nullptr ? usual : static_cast<unsigned>(std::atoi(text));
}

/// Each is for another motor. What is read has a value of its own; what is written is the same, as
/// when several axes start together. The numbers of requests are their tickets.
Request request_of(Kind kind, std::size_t number) {
  const auto motor = static_cast<std::uint8_t>(number);
  constexpr std::int32_t value = 100;
  switch (kind) {
    case Kind::write: return {ModuleAddress{1}, Command::SAP, 4, motor, value};
    case Kind::move: return {ModuleAddress{1}, Command::MVP, 0, motor, value};
    case Kind::stop: return {ModuleAddress{1}, Command::MST, 0, motor, 0};
    default: return {ModuleAddress{1}, Command::GAP, 1, motor, 0};
  }
}
std::int32_t answer_to(const Request& request) {
  return request.command == Command::GAP ? 1000 + request.motor * 100 + request.type
                                         : request.value;
}
CallOptions options_of(Kind kind) {
  CallOptions options;
  if (kind == Kind::read_followed) options.proof = Proof::followed;
  if (kind == Kind::read_twice) options.proof = Proof::twice;
  return options;
}

/// A line and all that is on its way, as it can be copied and gone on with in another way.
struct World {
  engine::BusEngine engine{Framing::serial, Duration{}, {}};
  TimePoint now{1h};
  struct Coming {
    TimePoint at;
    Reply reply;
  };
  std::vector<Request> sent;  ///< What becomes of it is open.
  std::vector<Coming> coming;
  /// How often each request was, until it has ended.
  std::array<std::uint8_t, most_requests> executed{};
  std::size_t ended = 0;
  unsigned depth = 0;   ///< Datagrams that had a choice.
  unsigned faults = 0;  ///< Of those, the ones that went wrong.

  /// All that decides how it goes on.
  std::string state() const {
    engine::EngineState state(engine, now);
    state.add(sent.size());
    for (const auto& request : sent) state.add(request);
    state.add(coming.size());
    for (const auto& [at, reply] : coming) {
      state.add(at);
      state.add(reply);
    }
    for (const auto times : executed) state.add(times);
    state.add(depth);
    return state.bytes();
  }
};

/// The fewest faults with which an answer to each kind of request was wrong; 0: it never was.
using Fewest = std::array<unsigned, kinds>;

struct Extent {
  unsigned depth;            ///< How many datagrams have a choice.
  unsigned faults;           ///< How many of them go wrong at most.
  bool knows_states = true;  ///< Equal states with no fewer faults are gone on with once.
};

class Search {
 public:
  Search(Extent extent, std::vector<Kind> asked) : extent_(extent), asked_(std::move(asked)) {
    World world;
    for (std::size_t i = 0; i < asked_.size(); ++i)
      world.engine.submit(i, request_of(asked_[i], i), options_of(asked_[i]), world.now);
    explore(std::move(world));
  }

  std::size_t states() const { return known_.size(); }
  std::size_t ways() const { return ways_; }
  const Fewest& fewest() const { return fewest_; }

 private:
  void explore(World world) {
    while (world.ended < asked_.size()) {
      if (const auto action = world.engine.next_action()) {
        note(world, *action);
      } else if (world.sent.empty()) {
        pass(world);
      } else if (may_go_wrong(world)) {
        if (extent_.knows_states && !is_new(world)) return;
        return explore_fates(world);
      } else {
        take(world, Fate::delivered);
      }
    }
    ++ways_;
  }
  bool may_go_wrong(const World& world) const {
    return world.depth < extent_.depth && world.faults < extent_.faults;
  }

  void explore_fates(World& world) {
    ++world.depth;
    for (const auto fate : {Fate::lost, Fate::late, Fate::doubled}) {
      auto other = world;
      ++other.faults;
      take(other, fate);
      explore(std::move(other));
    }
    take(world, Fate::delivered);
    explore(std::move(world));
  }

  /// That two of a hundred thousand states have the same hash happens once in ten billion searches.
  bool is_new(const World& world) {
    const auto state = std::hash<std::string>()(world.state());
    const auto [known, added] = known_.try_emplace(state, world.faults);
    if (!added && known->second <= world.faults) return false;
    known->second = world.faults;
    return true;
  }

  void note(World& world, const engine::Action& action) {
    if (const auto* send = std::get_if<engine::Send>(&action)) {
      if (!send->leaves_ascii) world.sent.push_back(send->request);
    } else if (const auto* done = std::get_if<engine::Completion>(&action)) {
      ++world.ended;
      judge(world, *done);
    }
  }

  void take(World& world, Fate fate) const {
    const auto request = world.sent.front();
    world.sent.erase(world.sent.begin());
    if (fate == Fate::lost) return;
    for (std::size_t i = 0; i < asked_.size(); ++i) {
      if (request == request_of(asked_[i], i)) ++world.executed[i];
    }
    const Reply reply{default_host_address, 1, Status::ok, request.command, answer_to(request)};
    const auto delay = fate == Fate::late ? too_late : to_answer;
    world.coming.push_back({world.now + delay, reply});
    if (fate == Fate::doubled) world.coming.push_back({world.now + delay + second_later, reply});
  }

  static void pass(World& world) {
    const auto next = std::ranges::min_element(world.coming, {}, &World::Coming::at);
    const auto deadline = world.engine.next_deadline();
    ASSERT_TRUE(next != world.coming.end() || deadline) << "a call has no end";
    if (next == world.coming.end() || (deadline && *deadline < next->at)) {
      world.now = std::max(world.now, *deadline);
      return world.engine.on_deadline(world.now);
    }
    world.now = std::max(world.now, next->at);
    const auto bytes = encode_serial(next->reply);
    world.coming.erase(next);
    world.engine.on_bytes(bytes, world.now);
  }

  void judge(World& world, const engine::Completion& done) {
    const auto kind = asked_[done.ticket];
    const auto request = request_of(kind, done.ticket);
    const auto times = std::exchange(world.executed[done.ticket], 0);
    if (kind == Kind::move) {
      ASSERT_LE(times, 1) << "a movement went out twice";
    }
    if (!done.result) return;
    const bool right = times > 0 && done.result->reply.value == answer_to(request);
    auto& least = fewest_[static_cast<std::size_t>(kind)];
    if (!right && (least == 0 || world.faults < least)) least = world.faults;
  }

  Extent extent_;
  std::vector<Kind> asked_;
  std::unordered_map<std::size_t, unsigned> known_;  ///< With how many faults at least.
  std::size_t ways_ = 0;
  Fewest fewest_{};
};

struct Findings {
  void add(const Search& search) {
    states += search.states();
    ways += search.ways();
    for (std::size_t kind = 0; kind < kinds; ++kind) {
      const auto faults = search.fewest()[kind];
      auto& least = fewest[kind];
      if (faults != 0 && (least == 0 || faults < least)) least = faults;
    }
  }
  std::size_t states = 0;
  std::size_t ways = 0;
  Fewest fewest{};
};

/// Of all three requests, on as many threads as there are processors.
Findings search_all(Extent extent) {
  Findings all;
  std::mutex adding;
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (auto number = next++; number < kinds * kinds * kinds; number = next++) {
      const auto kind = [](std::size_t digits) { return static_cast<Kind>(digits % kinds); };
      const Search search(extent,
                          {kind(number), kind(number / kinds), kind(number / kinds / kinds)});
      const std::scoped_lock lock(adding);
      all.add(search);
    }
  };
  std::vector<std::jthread> workers(std::max(1U, std::thread::hardware_concurrency()));
  for (auto& worker : workers) worker = std::jthread(work);
  workers.clear();
  return all;
}

TEST(AnswersSearch, NamesTheSmallestFaultThatBreaksEachPromise) {
  const auto found = search_all({setting("TMCL_DEPTH", 9), setting("TMCL_FAULTS", 3)});
  std::cout << found.states << " states with a choice, " << found.ways << " ways to an end\n";
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    const auto faults = found.fewest[kind];
    std::cout << names[kind] << ": "
              << (faults == 0 ? "never wrong" : "wrong with " + std::to_string(faults)) << "\n";
  }
  // What docs/SAFETY.md says; 0: more than were tried.
  constexpr Fewest needed{1, 2, 3, 2, 2, 2};
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    const auto fewest = found.fewest[kind];
    EXPECT_TRUE(fewest == 0 || fewest >= needed[kind]) << names[kind];
  }
}

TEST(AnswersSearch, FindsTheSameWhereEqualStatesAreGoneOnWithOnce) {
  constexpr unsigned depth = 5;
  const auto once = search_all({depth, depth});
  const auto every_time = search_all({depth, depth, false});
  EXPECT_EQ(once.fewest, every_time.fewest);
  EXPECT_LT(once.ways, every_time.ways);
  EXPECT_EQ(every_time.states, 0);
}

}  // namespace
}  // namespace tmcl
