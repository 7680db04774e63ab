// However many clients there are and whatever they do: a stop finds its way.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include "support/build_paths.hpp"
#include "system/tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

constexpr int most_clients = 1024;

double ms(Clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); }

class TmcldCrowd : public TmcldTest {
 protected:
  TmcldCrowd() {
    rlimit limit{};
    ::getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &limit);
    start_simulator_on_pty();
    write_config(pty_link());
  }
  /// The daemon, from a shell that has done something first.
  void start_daemon_after(const std::string& preparation, const std::string& behind = {}) {
    const auto line = preparation + "; exec " TMCL_BIN_DIR "/tmcld --config " + config() + behind;
    daemon = std::make_unique<Program>(std::vector<std::string>{"/bin/sh", "-c", line});
  }
  void connect(int clients) {
    for (int i = 0; i < clients; ++i) crowd.push_back(std::make_unique<RpcClient>(socket(), false));
  }
  void expect_that_tmclctl_stops(const std::string& axis) {
    Program stop({"tmclctl", "--socket", socket(), "stop", axis});
    EXPECT_EQ(stop.wait(), 0) << stop.output();
    EXPECT_EQ(stop.output(), axis + " stops\n");
  }

  std::vector<std::unique_ptr<RpcClient>> crowd;
};

TEST_F(TmcldCrowd, OfMoreClientsThanThereIsRoomForLeavesRoomForStops) {
  start_daemon();
  RpcClient first(socket());
  first.result("axis.rotate", {{"axis", "y"}, {"velocity_internal", 100}});
  connect(most_clients + 100);
  expect_that_tmclctl_stops("y");
  Program all({"tmclctl", "--socket", socket(), "stop", "--all"});
  EXPECT_EQ(all.wait(), 0) << all.output();
  RpcClient late(socket());
  EXPECT_EQ(late.greeting().at("params").at("serves"), "stops");
  const auto refusal = late.error("axis.list");
  EXPECT_EQ(refusal.at("code"), -32001);
  EXPECT_EQ(refusal.at("data").at("name"), "too_many_clients");
  late.result("axis.stop", {{"axis", "x"}});
  while (first.result("axis.get_state", {{"axis", "y"}}).at("moving").as_bool()) {
  }
  crowd.clear();
  while (RpcClient(socket()).greeting().at("params").as_object().contains("serves")) {
  }
}

TEST_F(TmcldCrowd, WithFewDescriptorsLeavesSomeForStopsAndForTheBus) {
  start_daemon_after("ulimit -n 64");
  ASSERT_TRUE(daemon->wait_for("module_answers (module 2)")) << daemon->output();
  RpcClient first(socket());
  first.result("axis.rotate", {{"axis", "y"}, {"velocity_internal", 100}});
  connect(100);
  expect_that_tmclctl_stops("y");
  simulator.reset();
  ASSERT_TRUE(daemon->wait_for("link_lost")) << daemon->output();
  start_simulator_on_pty();
  ASSERT_TRUE(daemon->wait_for("link_restored")) << daemon->output();
  expect_that_tmclctl_stops("y");
}

TEST_F(TmcldCrowd, OrADaemonThatDoesNotAnswerLeavesNobodyWithoutAnAnswerAfterASecond) {
  start_daemon();
  daemon->signal(SIGSTOP);
  const auto asked = Clock::now();
  Program stop({"tmclctl", "--socket", socket(), "stop", "y"});
  EXPECT_EQ(stop.wait(), 3) << stop.output();
  const auto took = Clock::now() - asked;
  EXPECT_THAT(stop.output(), HasSubstr("does not greet in time"));
  EXPECT_LT(took, 5s) << "on a busy machine";
  std::cout << "told after " << ms(took) << " ms\n";
  daemon->signal(SIGCONT);
  RpcClient(socket()).result("axis.list");
}

TEST_F(TmcldCrowd, AndALogThatNobodyReadsKeepNoStopWaiting) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::fcntl(ends[1], F_SETFL, O_NONBLOCK);
  const std::string junk(4096, '.');
  while (::write(ends[1], junk.data(), junk.size()) > 0) {
  }
  ::fcntl(ends[0], F_SETFD, FD_CLOEXEC);
  start_daemon_after("true", " 2>/proc/self/fd/" + std::to_string(ends[1]));
  ::close(ends[1]);
  std::unique_ptr<RpcClient> client;
  while (!client) {
    try {
      client = std::make_unique<RpcClient>(socket());
    } catch (const std::runtime_error&) {
      std::this_thread::yield();
    }
  }
  client->result("axis.rotate", {{"axis", "y"}, {"velocity_internal", 100}});
  connect(most_clients + 100);
  for (int i = 0; i < 3000; ++i) RpcClient(socket(), false).hang_up();
  expect_that_tmclctl_stops("y");
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(), 0);
  ::close(ends[0]);
}

/// Clients that each have some calls in progress all the time.
class Flood {
 public:
  Flood(const std::string& socket, int clients, int calls_each) {
    for (int i = 0; i < clients; ++i) {
      clients_.push_back(std::make_unique<RpcClient>(socket));
      for (int call = 0; call < calls_each; ++call) ask(i);
    }
    thread_ = std::thread([this] { run(); });
  }
  ~Flood() {
    ending_ = true;
    thread_.join();
  }
  std::uint64_t answers() const { return answers_; }

 private:
  void run() {
    while (!ending_) {
      for (int i = 0; i < static_cast<int>(clients_.size()); ++i) {
        while (clients_[static_cast<std::size_t>(i)]->read_line(0)) {
          ++answers_;
          ask(i);
        }
      }
    }
  }
  void ask(int client) {
    auto& to = *clients_[static_cast<std::size_t>(client)];
    switch (++asked_ % 4) {
      case 0: to.send("axis.stop", {{"axis", "z"}}); break;
      case 1: to.send("axis.get_state", {{"axis", "y"}}); break;
      case 2:
        to.send("parameter.set",
                {{"axis", "z"}, {"parameter", 4}, {"value", 100 + static_cast<int>(asked_ % 900)}});
        break;
      default:
        to.send("axis.move_to",
                {{"axis", "z"}, {"position_microsteps", static_cast<int>(asked_ % 900)}});
    }
  }

  std::vector<std::unique_ptr<RpcClient>> clients_;
  std::uint64_t asked_ = 0;
  std::atomic<std::uint64_t> answers_ = 0;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

TEST_F(TmcldCrowd, OfTwoHundredFloodingClientsLeavesAStopQuick) {
  constexpr int stops = 200;
  start_daemon();
  RpcClient client(socket());
  Flood flood(socket(), 200, 4);
  const auto began = Clock::now();
  std::vector<double> times;
  for (int i = 0; i < stops; ++i) {
    const auto asked = Clock::now();
    client.result("axis.stop", {{"axis", "y"}});
    times.push_back(ms(Clock::now() - asked));
  }
  const auto lasted = std::chrono::duration<double>(Clock::now() - began).count();
  std::ranges::sort(times);
  std::cout << "stop beside 200 flooding clients (" << static_cast<double>(flood.answers()) / lasted
            << " answers/s to them): p50 " << times[stops / 2] << " ms, p99 "
            << times[stops * 99 / 100] << " ms, max " << times.back() << " ms\n";
}

}  // namespace
}  // namespace tmcl::test
