// Real programs that are killed, held up and started again at random moments: in the end nothing
// turns, nobody hangs, and whoever ended by itself has said how.
#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "system/tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

using namespace std::chrono_literals;
using Words = std::vector<std::string>;

constexpr int usual_rounds = 2;
constexpr int events_of_a_round = 15;
constexpr int most_clients = 6;
// As long as a busy computer may need: nothing here is about how fast something is.
constexpr auto patience = 60s;
constexpr int killed = 128 + SIGKILL;

class Chaos : public TmcldTest {
 protected:
  explicit Chaos(std::uint64_t seed = tmcl::test::seed()) : random(seed) {}

  void start_table() {
    start_simulator({"--pty", path("pty"), "--tcp", "127.0.0.1:0"});
    port_ = tcp_address();
  }
  void begin_daemon() {
    daemon = std::make_unique<Program>(daemon_words());
    ASSERT_TRUE(daemon->wait_for("serving 3 axes")) << daemon->output();
  }
  virtual Words daemon_words() const { return {"tmcld", "--config", config()}; }

  void begin_client() {
    static const std::vector<Words> ways{{"rotate", "x", "300"},
                                         {"rotate", "y", "-300"},
                                         {"rotate", "z", "200"},
                                         {"move", "y", "4000"},
                                         {"move", "x", "-9000", "--wait"},
                                         {"stop", "x"},
                                         {"stop", "--all"},
                                         {"state", "z"},
                                         {"watch", "y"},
                                         {"get", "x", "max_velocity"},
                                         {"recover", "y"}};
    Words words{"tmclctl", "--socket", socket()};
    const auto& way = ways[index(ways.size())];
    words.insert(words.end(), way.begin(), way.end());
    clients.push_back({std::make_unique<Program>(words), way});
  }
  /// Whoever has ended by itself, or by Ctrl-C, has ended as documented.
  void end_client(std::size_t number, int signal) {
    auto client = std::move(clients[number]);
    clients.erase(clients.begin() + static_cast<std::ptrdiff_t>(number));
    client.program->signal(SIGCONT);
    client.program->signal(signal);
    const auto status = client.program->wait();
    static const std::set<int> documented{0, 1, 2, 3, 4, 5, 130, 143};
    const bool is_killed = signal == SIGKILL && status == killed;
    EXPECT_TRUE(documented.contains(status) || is_killed)
        << testing::PrintToString(client.way) << " ended with " << status << ": "
        << client.program->output();
  }

  void happen() {
    const auto pause = [&] { std::this_thread::sleep_for(10ms * random.any_size(50)); };
    switch (random.between(0, 9)) {
      case 0:
        daemon->signal(SIGSTOP);
        pause();
        // So long that it notices.
        if (random.one_in(4)) std::this_thread::sleep_for(2s);
        return daemon->signal(SIGCONT);
      case 1:
        simulator->signal(SIGSTOP);
        pause();
        return simulator->signal(SIGCONT);
      case 2:
        daemon->signal(SIGKILL);
        EXPECT_EQ(daemon->wait(), killed) << daemon->output();
        return begin_daemon();
      case 3:
        // Both of its lines are cut, too.
        simulator.reset();
        pause();
        return start_table();
      case 4:
      case 5:
        if (!clients.empty())
          end_client(index(clients.size()), random.one_in(2) ? SIGKILL : SIGTERM);
        return;
      case 6:
        if (!clients.empty()) clients[index(clients.size())].program->signal(SIGSTOP);
        return;
      default:
        if (clients.size() >= most_clients) end_client(0, SIGTERM);
        begin_client();
        return pause();
    }
  }

  /// Until the daemon has met all modules, and so knows what moves.
  void await_modules() const {
    const auto until = std::chrono::steady_clock::now() + patience;
    for (const char* axis : {"x", "y", "z"}) {
      const Words look{"tmclctl", "--socket", socket(), "state", axis};
      while (run_program(look).status != 0 && std::chrono::steady_clock::now() < until)
        std::this_thread::sleep_for(200ms);
    }
  }

  /// What a motor does, asked past the daemon.
  std::string velocity_of(const std::string& motor) const {
    return run_program({"tmclctl", "--direct", "tcp:" + port_, "get", motor, "actual_velocity"})
        .output;
  }
  void expect_all_stand() const {
    const auto until = std::chrono::steady_clock::now() + patience;
    for (const char* motor : {"1/0", "2/0", "2/1", "2/2"}) {
      auto velocity = velocity_of(motor);
      while (velocity != "0\n" && std::chrono::steady_clock::now() < until) {
        std::this_thread::sleep_for(200ms);
        velocity = velocity_of(motor);
      }
      EXPECT_EQ(velocity, "0\n") << motor << " turns";
    }
  }

  void run_round() {
    start_table();
    write_config(pty_link());
    begin_daemon();
    for (int event = 0; event < events_of_a_round && !HasFatalFailure(); ++event) happen();
    while (!clients.empty()) end_client(0, random.one_in(2) ? SIGKILL : SIGTERM);
    // One that was started again a moment ago does not know yet that something turns.
    await_modules();
    daemon->signal(SIGTERM);
    EXPECT_EQ(daemon->wait(), 0) << daemon->output();
    expect_all_stand();
    simulator.reset();
  }
  void run_rounds() {
    for (int round = 0; round < rounds(usual_rounds) && !HasFailure(); ++round) run_round();
  }

  std::size_t index(std::size_t size) {
    return static_cast<std::size_t>(random.between(0, static_cast<std::int64_t>(size) - 1));
  }

  struct Client {
    std::unique_ptr<Program> program;
    Words way;
  };
  Random<> random;
  std::vector<Client> clients;

 private:
  std::string port_;
};

TEST_F(Chaos, LeavesNothingThatTurns) { run_rounds(); }

/// Hardly any descriptors, and a disk on which nothing can be written.
class PoorChaos : public Chaos {
 protected:
  Words daemon_words() const override {
    return {"/bin/sh", "-c",
            "ulimit -n 48; ulimit -f 0; trap '' XFSZ; exec '" TMCL_BIN_DIR "/tmcld' --config '" +
                config() + "'"};
  }
};

TEST_F(PoorChaos, LeavesNothingThatTurns) { run_rounds(); }

}  // namespace
}  // namespace tmcl::test
