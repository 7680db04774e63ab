// The smallest fault that gives a question the answer to another: every way in which a line can
// treat the first datagrams of up to three requests is tried.
//
// TMCL_DEPTH is how many datagrams have a choice (9; .ci/nightly takes 12), TMCL_FAULTS how many of
// them go wrong at most (3). What comes after is delivered.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <vector>

#include "engine/bus_engine.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;

enum class Kind : std::uint8_t { read, read_followed, read_twice, write, move, stop };
constexpr std::size_t kinds = 6;
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
  std::vector<Coming> coming;
  std::vector<Request> executed;
  std::size_t ended = 0;
  unsigned depth = 0;   ///< Datagrams that had a choice.
  unsigned faults = 0;  ///< Of those, the ones that went wrong.
};

class Search {
 public:
  explicit Search(std::vector<Kind> asked) : asked_(std::move(asked)) {}

  void run() {
    World world;
    for (std::size_t i = 0; i < asked_.size(); ++i)
      world.engine.submit(i, request_of(asked_[i], i), options_of(asked_[i]), world.now);
    explore(std::move(world));
  }

  static inline std::size_t states = 0;
  /// The fewest faults with which an answer to each kind of request was wrong.
  static inline std::array<unsigned, kinds> fewest{};

 private:
  void explore(World world) {
    ++states;
    while (world.ended < asked_.size()) {
      const auto action = world.engine.next_action();
      if (!action) {
        pass(world);
      } else if (const auto* send = std::get_if<engine::Send>(&*action)) {
        if (world.depth < most_depth && world.faults < most_faults) {
          for (const auto fate : {Fate::lost, Fate::late, Fate::doubled}) {
            auto other = world;
            ++other.faults;
            take(other, send->request, fate);
            explore(std::move(other));
          }
        }
        take(world, send->request, Fate::delivered);
      } else if (const auto* done = std::get_if<engine::Completion>(&*action)) {
        ++world.ended;
        judge(world, *done);
      }
    }
  }

  static void take(World& world, const Request& request, Fate fate) {
    ++world.depth;
    if (fate == Fate::lost) return;
    world.executed.push_back(request);
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

  void judge(const World& world, const engine::Completion& done) {
    const auto kind = asked_[done.ticket];
    const auto request = request_of(kind, done.ticket);
    const auto times = std::ranges::count(world.executed, request);
    if (kind == Kind::move) {
      ASSERT_LE(times, 1) << "a movement went out twice";
    }
    if (!done.result) return;
    const bool right = times > 0 && done.result->reply.value == answer_to(request);
    auto& least = fewest[static_cast<std::size_t>(kind)];
    if (!right && (least == 0 || world.faults < least)) least = world.faults;
  }

  const unsigned most_depth = setting("TMCL_DEPTH", 9);
  const unsigned most_faults = setting("TMCL_FAULTS", 3);
  std::vector<Kind> asked_;
};

TEST(AnswersSearch, NamesTheSmallestFaultThatBreaksEachPromise) {
  for (std::size_t first = 0; first < kinds; ++first) {
    for (std::size_t second = 0; second < kinds; ++second) {
      for (std::size_t third = 0; third < kinds; ++third)
        Search({static_cast<Kind>(first), static_cast<Kind>(second), static_cast<Kind>(third)})
            .run();
    }
  }
  std::cout << Search::states << " ways\n";
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    const auto faults = Search::fewest[kind];
    std::cout << names[kind] << ": "
              << (faults == 0 ? "never wrong" : "wrong with " + std::to_string(faults)) << "\n";
  }
  // What docs/SAFETY.md says; 0: more than were tried.
  const auto needs = [](Kind kind, unsigned faults) {
    const auto fewest = Search::fewest[static_cast<std::size_t>(kind)];
    return fewest == 0 || fewest >= faults;
  };
  EXPECT_TRUE(needs(Kind::read, 1));
  EXPECT_TRUE(needs(Kind::read_followed, 2));
  EXPECT_TRUE(needs(Kind::read_twice, 3));
  EXPECT_TRUE(needs(Kind::write, 2));
  EXPECT_TRUE(needs(Kind::move, 2));
  EXPECT_TRUE(needs(Kind::stop, 2));
}

}  // namespace
}  // namespace tmcl
