// Whatever can move an axis is asked for, alone and side by side, and then a stop: on one
// connection or two, with modules that are slow or lose answers, whether the daemon knows the
// modules already or not. Behind the stop nothing goes out that was asked for before it.
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;
using tmcl::Request;

const tmcl::AxisAddress x{tmcl::ModuleAddress{1}, 0};

struct Stop {
  std::string method;
  json::object params;
};
const std::vector<Stop>& stops() {
  static const std::vector<Stop> all{
      {"axis.stop", {{"axis", "x"}}},
      {"system.stop_all", {}},
      {"module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "MST"}}}};
  return all;
}

class Round {
 public:
  explicit Round(bool until_ready = true, Limits limits = Limits::none)
      : bench_(until_ready, limits) {}
  ~Round() {
    lose({});
    bench_.daemon.on_reactor([&] { return bench_.daemon.wire().release(), 0; });
  }

  /// So that all that moves is known to the daemon from before.
  void warm_up() {
    for (const auto* axis : {"x", "y"})
      bench_.client->result("axis.move_to", {{"axis", axis}, {"position", 0}});
  }
  void lose(std::function<bool(const Request&)> which) {
    bench_.daemon.on_reactor([&] { return bench_.daemon.wire().loses = which, 0; });
  }
  /// Answers come only with breathe().
  void be_slow() {
    bench_.daemon.on_reactor([&] { return bench_.daemon.wire().holds = true, 0; });
  }
  void breathe() {
    bench_.daemon.on_reactor([&] {
      bench_.daemon.wire().release();
      return bench_.daemon.wire().holds = true, 0;
    });
  }

  void ask(const MovingExample& example) {
    for (const auto& step : example.steps) write(*bench_.client, step.method, step.params);
  }
  void send() { bench_.client->send_raw(std::exchange(lines_, {})); }
  /// What was sent has come in when this returns.
  void see_it_come_in() {
    write(*bench_.client, "axis.list", {});
    const auto id = last_id_;
    send();
    answer_to(*bench_.client, id);
  }
  /// Gives the answer; `meanwhile` is called until it is there.
  json::object stop(const Stop& stop, bool by_another, const std::function<void()>& meanwhile) {
    auto& client = by_another ? other_ : *bench_.client;
    write(client, stop.method, stop.params);
    const auto id = last_id_;
    client.send_raw(std::exchange(lines_, {}));
    auto answer = answer_to(client, id, meanwhile);
    // Later ones come from what was asked for before, and they are stops of x, too: of a path.
    stopped_at_ = bench_.daemon.on_reactor([&] {
      const auto& seen = bench_.daemon.wire().seen;
      const auto last =
          std::ranges::find_if(seen.rbegin(), seen.rend(), [](const Request& request) {
            return request.command == Command::MST && request.motor == 0;
          });
      return static_cast<std::size_t>(seen.rend() - last);
    });
    return answer;
  }
  /// Returns when all calls have been answered.
  void let_all_end() {
    bench_.daemon.on_reactor([&] { return bench_.daemon.wire().release(), 0; });
    while (!waiting_.empty()) answer_to(*bench_.client, *waiting_.begin());
  }
  std::vector<std::string> moves(std::size_t from) {
    return bench_.daemon.on_reactor([&] {
      std::vector<std::string> moves;
      const auto& seen = bench_.daemon.wire().seen;
      for (auto i = from; i < seen.size(); ++i)
        if (can_move(seen[i], x)) moves.push_back(describe(seen[i]));
      return moves;
    });
  }
  std::vector<std::string> moves_behind_the_stop() { return moves(stopped_at_); }
  TestDaemon& daemon() { return bench_.daemon; }

 private:
  void write(const RpcClient& to, const std::string& method, const json::object& params) {
    lines_ += json::serialize(json::object{
                  {"jsonrpc", "2.0"}, {"id", ++last_id_}, {"method", method}, {"params", params}}) +
              '\n';
    if (&to == bench_.client.get()) waiting_.insert(last_id_);
  }
  json::object answer_to(RpcClient& client, int id, const std::function<void()>& meanwhile = {}) {
    const auto limit = bench_.daemon.now() + std::chrono::seconds(20);
    while (bench_.daemon.now() < limit) {
      if (meanwhile) meanwhile();
      const auto message = client.read(meanwhile ? 1 : RpcClient::patience_ms);
      const auto* found = message.is_object() ? message.as_object().if_contains("id") : nullptr;
      if (found == nullptr) continue;
      waiting_.erase(static_cast<int>(found->as_int64()));
      if (*found == id) return message.as_object();
    }
    throw std::runtime_error("no answer to " + std::to_string(id));
  }

  MovesBench bench_;
  RpcClient other_{bench_.daemon.socket()};
  std::string lines_;
  std::set<int> waiting_;
  int last_id_ = 1000;
  std::size_t stopped_at_ = 0;
};

bool is_upload(const MovingExample& example) { return example.method() == "firmware.upload"; }

// Otherwise what follows says nothing.
TEST(DaemonStopExamples, MoveX) {
  for (const auto& example : moving_examples()) {
    SCOPED_TRACE(testing::PrintToString(example));
    Round round;
    round.ask(example);
    round.send();
    EXPECT_TRUE(round.daemon().eventually([&] {
      return std::ranges::any_of(round.daemon().wire().seen,
                                 [](const Request& request) { return can_move(request, x); });
    }));
  }
}

class DaemonStopEveryMethod : public testing::TestWithParam<Limits> {};
INSTANTIATE_TEST_SUITE_P(With, DaemonStopEveryMethod, testing::Values(Limits::none, Limits::wide),
                         [](const auto& one) {
                           return one.param == Limits::none ? "no_limits" : "soft_limits";
                         });

TEST_P(DaemonStopEveryMethod, AStopInTheSameWriteWins) {
  for (const auto& example : moving_examples()) {
    for (const auto& stop : stops()) {
      SCOPED_TRACE(testing::PrintToString(example) + ' ' + stop.method);
      Round round(true, GetParam());
      round.ask(example);
      const auto answer = round.stop(stop, false, {});
      EXPECT_TRUE(answer.contains("result")) << json::serialize(answer);
      round.let_all_end();
      EXPECT_THAT(round.moves_behind_the_stop(), testing::IsEmpty());
    }
  }
}

class DaemonStopRandom : public testing::Test {
 protected:
  bool chance(unsigned of) { return random_() % of == 0; }
  template <class List>
  const auto& any_of(const List& list) {
    return list[random_() % list.size()];
  }

  void play() {
    const auto examples = moving_examples();
    std::vector<MovingExample> chosen{any_of(examples)};
    if (chance(2)) chosen.push_back(any_of(examples));
    const auto& stop = any_of(stops());
    const auto limits = chance(2) ? Limits::wide : Limits::none;
    const bool is_known = !chance(4);
    const bool is_warm = is_known && chance(2);
    const bool is_slow = chance(2);
    const bool loses = chance(3);
    const bool by_another = chance(2);
    const auto pauses = random_() % 4;
    SCOPED_TRACE(testing::PrintToString(chosen) + ' ' + stop.method +
                 (limits == Limits::wide ? ", soft limits" : "") +
                 (is_known ? "" : ", unknown modules") + (is_warm ? ", warm" : "") +
                 (is_slow ? ", slow" : "") + (loses ? ", lost answers" : "") +
                 (by_another ? ", by another" : ""));
    Round round(is_known, limits);
    if (is_warm) round.warm_up();
    if (loses) {
      round.lose([generator = random_](const Request&) mutable { return generator() % 4 == 0; });
      random_.discard(1);
    }
    if (is_slow) round.be_slow();
    for (const auto& example : chosen) round.ask(example);
    const auto breathe = [&] {
      if (is_slow) round.breathe();
    };
    if (by_another) round.see_it_come_in();
    for (auto i = by_another ? pauses : 0; i > 0; --i) {
      breathe();
      round.see_it_come_in();
    }
    const auto answer = round.stop(stop, by_another, breathe);
    // It may have been lost; and a module in its bootloader obeys no stop.
    if (!answer.contains("result")) return;
    ++stopped_;
    if (std::ranges::none_of(chosen, is_upload)) round.let_all_end();
    EXPECT_THAT(round.moves_behind_the_stop(), testing::IsEmpty());
  }

  std::mt19937_64 random_{tmcl::test::seed()};
  int stopped_ = 0;
};

TEST_F(DaemonStopRandom, NothingAskedForBeforeAStopGoesOutBehindIt) {
  const int rounds = tmcl::test::rounds(60);
  for (int i = 0; i < rounds && !HasFailure(); ++i) play();
  EXPECT_GT(stopped_, rounds / 3);
}

}  // namespace
}  // namespace tmcld::test
