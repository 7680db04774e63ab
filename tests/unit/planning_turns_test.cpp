// Clients take turns where paths are planned, and a stop waits for no plan.
#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "async/spawn.hpp"
#include "async/turns.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "unit/journey_bench.hpp"
#include "world/world_peer.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::HasSubstr;

// ---- turns -------------------------------------------------------------------------------------

/// Each turn takes a second.
class TurnsTest : public testing::Test {
 protected:
  void ask(std::uint64_t client, int times = 1) {
    for (int i = 0; i < times; ++i) spawn(context_.get_executor(), work(client));
  }
  boost::asio::awaitable<void> work(std::uint64_t client) {
    const auto turn = co_await turns.take(client);
    began.push_back(client);
    co_await rest(1s);
  }

 private:
  boost::asio::io_context context_{1};

 public:
  tmcl::VirtualTime time{context_};
  Turns turns;
  std::vector<std::uint64_t> began;
};

TEST_F(TurnsTest, GoRoundHoweverMuchOneClientAsks) {
  ask(1, 4);
  ask(2, 4);
  time.run_for(500ms);
  ask(3, 2);
  time.run_for(1h);
  EXPECT_THAT(began, testing::ElementsAre(1, 2, 3, 1, 2, 3, 1, 2, 1, 2));
}

TEST_F(TurnsTest, ComeAfterOneOfEachOtherClientAtMost) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<int> random(seed);
  for (int i = 0; i < 200; ++i) {
    const auto newcomer = static_cast<std::uint64_t>(100 + i);
    const auto clients = static_cast<std::uint64_t>(random.between(1, 8));
    for (std::uint64_t client = 1; client <= clients; ++client) ask(client, random.between(1, 5));
    time.run_for(std::chrono::milliseconds(random.between(0, 20'000)));
    ask(newcomer);
    began.clear();
    time.run_for(10s);
    ASSERT_LE(std::ranges::find(began, newcomer) - began.begin(), 8)
        << "TMCL_SEED=" << seed << ", round " << i;
  }
}

TEST_F(TurnsTest, AreGivenBackByThoseWhoEndBefore) {
  {
    boost::asio::io_context other(1);
    tmcl::VirtualTime its_time(other);
    const auto wait = [](Turns& of) -> boost::asio::awaitable<void> {
      const auto turn = co_await of.take(7);
      co_await rest(1h);
    };
    for (int i = 0; i < 3; ++i) spawn(other.get_executor(), wait(turns));
    its_time.settle();
  }
  ask(8);
  time.settle();
  EXPECT_THAT(began, testing::ElementsAre(8));
}

// ---- plans -------------------------------------------------------------------------------------

class PlanningTurns : public JourneyBench, public testing::Test {
 protected:
  static constexpr tmcl::Duration piece = 2s;  // of a plan, of which there are two

  PlanningTurns() : JourneyBench("TMCM-3110", "unit = \"mm\"\nunits_per_revolution = 5\n") {
    time.set_time_for_work([] { return piece; });
    gateway->planning.set_limit(std::size_t{4} << 20);
  }

  using Answer = std::shared_ptr<std::optional<Result<boost::json::object>>>;

  std::shared_ptr<Peer> client() {
    auto peer = std::make_shared<WorldPeer>(trace_);
    peer->number = gateway->add_client("client").number;
    return peer;
  }
  Answer begin(const std::shared_ptr<Peer>& peer, std::string_view method, json::object params) {
    auto answer = std::make_shared<std::optional<Result<boost::json::object>>>();
    auto carry_out = [](auto of, auto by, RpcRequest request,
                        Answer into) -> boost::asio::awaitable<void> {
      auto result = co_await dispatch(std::move(of), std::move(by), std::move(request));
      *into = std::move(result);
    };
    const RpcRequest request{1, find_method(method), std::move(params)};
    spawn(executor(), carry_out(gateway, peer, request, answer));
    return answer;
  }
  Answer begin_plan(const std::shared_ptr<Peer>& peer, std::size_t bytes) {
    std::string text = "G1 F600\n";
    while (text.size() < bytes) text += "G1 X1\nG1 X0\n";
    return begin(peer, "path.plan", {{"axes", json::array{"x"}}, {"text", text}});
  }
  /// As many plans as it has room for, and one more.
  std::vector<Answer> fill(const std::shared_ptr<Peer>& peer) {
    std::vector<Answer> plans;
    for (int i = 0; i < 64; ++i) plans.push_back(begin_plan(peer, 20'000));
    time.settle();
    return plans;
  }
  static bool has_ended(const Answer& answer) { return answer->has_value(); }
  boost::asio::any_io_executor executor() const { return gateway->buses().front()->executor(); }

  /// Turns of the reactor until the condition holds.
  template <class Condition>
  int steps_until(Condition condition) {
    auto& context = static_cast<boost::asio::io_context&>(
        boost::asio::query(executor(), boost::asio::execution::context));
    int steps = 0;
    while (!condition()) {
      context.restart();
      if (context.poll_one() > 0) {
        ++steps;
      } else {
        time.step();
      }
    }
    return steps;
  }

 private:
  Trace trace_;
};

TEST_F(PlanningTurns, OneClientHasItsShareAndIsToldWhenThatIsFull) {
  const auto one = client();
  const auto plans = fill(one);
  const auto refused = std::ranges::find_if(plans, has_ended);
  ASSERT_NE(refused, plans.end());
  ASSERT_FALSE(***refused);
  const auto& error = (***refused).error();
  EXPECT_EQ(error.name, "queue_full");
  EXPECT_THAT(error.message, HasSubstr("plans of client wait"));
  EXPECT_THAT(error.message, HasSubstr("of memory for planning are taken"));

  const auto asked = time.now();
  const auto other = begin_plan(client(), 20'000);
  const auto late = begin_plan(client(), 200);
  time.run_while_not([&] { return has_ended(other); }, 1h);
  EXPECT_TRUE(**other);
  EXPECT_LT(time.now() - asked, 4 * piece + 1s) << "behind one of the first client";
  time.run_while_not([&] { return has_ended(late); }, 1h);
  EXPECT_TRUE(**late);
  EXPECT_LT(time.now() - asked, 8 * piece + 1s) << "each of the others had one turn at most";
  EXPECT_GT(std::ranges::count_if(plans, std::not_fn(has_ended)), 10);
}

TEST_F(PlanningTurns, ShareTheirMemoryWithCoursesThatArePassed) {
  constexpr std::size_t legs = 10'000;
  std::string text = "G1 F600\n";
  for (std::size_t leg = 0; leg < legs; leg += 2) text += "X1\nX0\n";
  const auto one = client();
  const auto run = begin(one, "path.run", {{"axes", json::array{"x"}}, {"text", text}});
  time.run_for(1min);
  ASSERT_FALSE(has_ended(run)) << (**run).error().message;
  EXPECT_GT(gateway->planning.taken(), legs * 100);
  const auto refused = begin_plan(one, 300'000);
  time.settle();
  ASSERT_TRUE(has_ended(refused));
  ASSERT_FALSE(**refused);
  EXPECT_EQ((**refused).error().name, "queue_full");
  EXPECT_THAT((**refused).error().message, HasSubstr("plans of client wait or are made, or its"));
  EXPECT_TRUE(gateway->planning.take(client()->client().number, "other", 1'000)) << "has room";

  begin(client(), "axis.stop", {{"axis", "x"}});
  time.run_while_not([&] { return has_ended(run); }, 1min);
  EXPECT_TRUE(has_ended(run));
  EXPECT_EQ(gateway->planning.taken(), 0U);
}

TEST_F(PlanningTurns, ShareTheirMemoryWithProgramsThatRun) {
  constexpr std::size_t groups = 10'000;
  std::string text = "SPEED = 9000\nACCEL = 90000\n";
  for (std::size_t group = 0; group < groups; group += 2) text += "MOVEA=500:GO:MOVEA=0:GO\n";
  const auto one = client();
  const auto run = begin(one, "mint.run", {{"axes", json::array{"x"}}, {"text", text}});
  time.run_for(1min);
  ASSERT_FALSE(has_ended(run)) << (**run).error().message;
  EXPECT_GT(gateway->planning.taken(), groups * 100);
  // It has room while it is planned, and not while it is run.
  const auto refused = begin(one, "mint.run", {{"axes", json::array{"y"}}, {"text", text}});
  time.run_while_not([&] { return has_ended(refused); }, 1min);
  ASSERT_TRUE(has_ended(refused));
  ASSERT_FALSE(**refused);
  EXPECT_EQ((**refused).error().name, "queue_full");
  EXPECT_THAT((**refused).error().message,
              HasSubstr("plans of client wait or are made, or its paths and programs run"));
  EXPECT_EQ(position("y"), 0);
  EXPECT_TRUE(gateway->planning.take(client()->client().number, "other", 1'000)) << "has room";

  begin(client(), "axis.stop", {{"axis", "x"}});
  time.run_while_not([&] { return has_ended(run); }, 1min);
  EXPECT_TRUE(has_ended(run));
  EXPECT_EQ(gateway->planning.taken(), 0U);
}

TEST_F(PlanningTurns, AStopComesAfterSoManyStepsWhateverIsPlanned) {
  const auto stop_steps = [&] {
    const auto stop = begin(client(), "axis.stop", {{"axis", "y"}});
    const auto sent_before = sent(tmcl::Command::MST).size();
    const auto asked = time.now();
    const auto steps = steps_until([&] { return sent(tmcl::Command::MST).size() > sent_before; });
    EXPECT_LT(time.now() - asked, 20ms);
    time.run_while_not([&] { return has_ended(stop); }, 1s);
    EXPECT_TRUE(**stop);
    return steps;
  };
  const auto alone = stop_steps();
  std::vector<std::shared_ptr<Peer>> clients;
  for (int i = 0; i < 5; ++i) {
    clients.push_back(client());
    fill(clients.back());
    EXPECT_LE(stop_steps(), alone + 20) << i;
  }
}

}  // namespace
}  // namespace tmcld::test
