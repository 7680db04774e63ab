// Clients that do anything at any time, on a link that comes and goes: every request is answered
// once, and every answer about a movement is true.
#include <map>
#include <random>

#include <gmock/gmock.h>

#include "support/seed.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;

constexpr int rounds = 150;
constexpr std::size_t client_count = 6;

class RandomClients : public DaemonTest {
 protected:
  RandomClients() {
    for (std::size_t i = 0; i < client_count; ++i) come(i);
  }

  struct Pending {
    std::map<int, std::int32_t> requests;  // the target of a movement, or 0
  };

  void come(std::size_t i) {
    clients_[i] = std::make_unique<RpcClient>(daemon.socket());
    pending_[i] = {};
  }

  void act(std::size_t i) {
    auto& one = *clients_[i];
    auto& requests = pending_[i].requests;
    const json::object axis{{"axis", random_() % 2 == 0 ? "x" : "y"}};
    switch (random_() % 32) {
      case 0: requests[one.send("axis.stop", axis)] = 0; break;
      case 1: requests[one.send("system.stop_all")] = 0; break;
      case 2: requests[one.send("axis.get_state", axis)] = 0; break;
      case 3: requests[one.send("subscribe", {{"interval_ms", 5}})] = 0; break;
      case 4: one.send_raw("{]\n"); break;
      case 5: collect(i); break;
      case 6: come(i); break;
      default: move(i, axis);
    }
  }

  // Each movement has a target of its own, so that the module's end knows it again.
  void move(std::size_t i, json::object params) {
    params["position_microsteps"] = ++last_target_;
    if (random_() % 4 == 0) params["deadline_ms"] = random_() % 20;
    pending_[i].requests[clients_[i]->send("axis.move_to", params)] = last_target_;
  }

  void collect(std::size_t i) {
    for (const auto& [id, target] : std::exchange(pending_[i].requests, {})) {
      const auto answer = clients_[i]->answer_to(id);
      if (target != 0) outcomes_[target] = outcome_in(answer);
    }
  }

  static std::string outcome_in(const json::object& answer) {
    if (answer.contains("result")) return "done";
    return text(answer.at("error").at("data").at("outcome"));
  }

  void disturb() {
    const auto what = random_() % 16;
    daemon.on_reactor([&] {
      auto& wire = daemon.wire();
      if (what == 0) {
        wire.unplug();
      } else if (what < 6) {
        wire.holds = true;
      } else {
        wire.release();
      }
      return 0;
    });
    // Calls without a link end at once: for a while, not for all of the test.
    if (what == 0) daemon.run_for(std::chrono::milliseconds(random_() % 2000));
  }

  void expect_truth() {
    std::map<std::int32_t, int> sent;
    daemon.on_reactor([&] {
      for (const auto& request : daemon.wire().seen) {
        if (request.command == Command::MVP) ++sent[request.value];
      }
      return 0;
    });
    for (const auto& [target, times] : sent) EXPECT_EQ(times, 1) << target;
    std::map<std::string, int> counts;
    for (const auto& [target, outcome] : outcomes_) {
      ++counts[outcome];
      if (outcome == "unknown") continue;
      EXPECT_EQ(sent.count(target), outcome == "done" ? 1U : 0U) << target << " " << outcome;
    }
    // Otherwise the disturbance was too great, or too small, to say anything.
    EXPECT_GT(counts["done"], 0);
    EXPECT_GT(counts["not_sent"], 0);
  }

  std::mt19937_64 random_{tmcl::test::seed()};
  std::array<std::unique_ptr<RpcClient>, client_count> clients_;
  std::array<Pending, client_count> pending_;
  std::map<std::int32_t, std::string> outcomes_;
  std::int32_t last_target_ = 0;
};

TEST_F(RandomClients, GetOneTrueAnswerToEachRequest) {
  for (int round = 0; round < rounds; ++round) {
    for (auto actions = random_() % 8; actions > 0; --actions) act(random_() % client_count);
    if (random_() % 4 == 0) disturb();
    daemon.run_for(std::chrono::milliseconds(20));
  }
  daemon.on_reactor([&] { return daemon.wire().release(), 0; });
  for (std::size_t i = 0; i < client_count; ++i) collect(i);
  expect_truth();
  EXPECT_EQ(client.result("axis.list").at("axes").as_array().size(), 2U);
}

}  // namespace
}  // namespace tmcld::test
