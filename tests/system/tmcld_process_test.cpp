// The daemon as it runs on a gateway: a process of its own, on a simulated bus, with clients.
#include <algorithm>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>

#include "system/tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::string text(const json::value& value) {
  const auto& string = value.as_string();
  return {string.data(), string.size()};
}

using Tmcld = TmcldTest;

void move_stop_and_watch(RpcClient& client, RpcClient& watcher) {
  watcher.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 10}});
  client.result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 10'000}});
  EXPECT_EQ(
      client.result("axis.wait", {{"axis", "x"}, {"timeout_ms", 20'000}}).at("position_microsteps"),
      10'000);
  std::int64_t seq = 0;
  std::int64_t position = -1;
  int states = 0;
  while (position != 10'000) {
    const auto state = watcher.notification("notify_state");
    ASSERT_FALSE(state.is_null());
    EXPECT_GT(state.at("seq").as_int64(), seq);
    EXPECT_GE(state.at("position_microsteps").as_int64(), position);
    seq = state.at("seq").as_int64();
    position = state.at("position_microsteps").as_int64();
    ++states;
  }
  EXPECT_GT(states, 1);

  client.result("axis.rotate", {{"axis", "z"}, {"velocity_internal", 500}});
  while (client.result("axis.get_state", {{"axis", "z"}}).at("velocity_internal") != 500) {
  }
  client.result("axis.stop", {{"axis", "z"}});
  while (client.result("axis.get_state", {{"axis", "z"}}).at("moving").as_bool()) {
  }
}

TEST_F(Tmcld, MovesStopsAndWatchesOnAPty) {
  start_simulator_on_pty();
  write_config(pty_link());
  start_daemon();
  RpcClient client(socket());
  RpcClient watcher(socket());
  move_stop_and_watch(client, watcher);
}

TEST_F(Tmcld, MovesStopsAndWatchesOverTcp) {
  start_simulator({"--tcp", "127.0.0.1:0"});
  write_config("tcp:" + tcp_address());
  start_daemon();
  RpcClient client(socket());
  RpcClient watcher(socket());
  move_stop_and_watch(client, watcher);
}

class TmcldLinkLoss : public TmcldTest {
 protected:
  static std::int64_t ticks(RpcClient& client) {
    return client
        .result("global.get", {{"bus", "bench"}, {"address", 1}, {"parameter", 132}, {"bank", 0}})
        .at("value")
        .as_int64();
  }
  // The simulator goes and comes back; nothing else is touched.
  void lose_and_regain(const std::vector<std::string>& port) {
    start_daemon();
    RpcClient client(socket());
    client.result("subscribe", {{"axes", json::array{"x"}}});
    const auto next_event = [&] { return text(client.notification("notify_event").at("kind")); };
    for (int round = 0; round < 3; ++round) {
      // A restart of a module that was on for a moment only is not noticed.
      while (ticks(client) < 200) std::this_thread::yield();
      client.result("axis.get_state", {{"axis", "x"}});
      client.result("axis.get_state", {{"axis", "y"}});
      simulator.reset();
      EXPECT_EQ(next_event(), "link_lost");
      EXPECT_EQ(text(client.error("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}})
                         .at("data")
                         .at("outcome")),
                "not_sent");
      start_simulator(port);
      EXPECT_EQ(next_event(), "link_restored");
      // It has started again meanwhile, too.
      std::map<std::string, int> told;
      for (int i = 0; i < 4; ++i) ++told[next_event()];
      EXPECT_EQ(told, (std::map<std::string, int>{{"module_reset", 2}, {"module_answers", 2}}));
      client.result("axis.recover", {{"axis", "x"}});
      client.result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 100}});
      EXPECT_EQ(client.result("axis.wait", {{"axis", "x"}}).at("position_microsteps"), 100);
    }
  }
};

TEST_F(TmcldLinkLoss, OfAPtyNeedsNoRestart) {
  start_simulator_on_pty();
  write_config(pty_link());
  lose_and_regain({"--pty", path("pty")});
}

TEST_F(TmcldLinkLoss, OfATcpPeerNeedsNoRestart) {
  start_simulator({"--tcp", "127.0.0.1:0"});
  const auto address = tcp_address();
  write_config("tcp:" + address);
  lose_and_regain({"--tcp", address});
}

TEST_F(Tmcld, WaitsForALinkThatIsNotThereYet) {
  write_config(pty_link());
  start_daemon(0);
  RpcClient client(socket());
  ASSERT_TRUE(daemon->wait_for("cannot be opened"));
  const auto bus = client.result("bus.list").at("buses").as_array().at(0);
  EXPECT_EQ(text(bus.at("state")), "opening");
  EXPECT_FALSE(bus.at("error").is_null());
  start_simulator_on_pty();
  ASSERT_TRUE(daemon->wait_for("module_answers (module 2)"));
  EXPECT_EQ(client.result("axis.get_state", {{"axis", "y"}}).at("position_microsteps"), 0);
}

TEST_F(Tmcld, ServesManyClientsAtOnce) {
  start_simulator_on_pty();
  write_config(pty_link());
  start_daemon();
  std::vector<std::unique_ptr<RpcClient>> clients;
  for (int i = 0; i < 20; ++i) clients.push_back(std::make_unique<RpcClient>(socket()));
  std::vector<int> requests;
  for (auto& client : clients) {
    client->send("axis.get_state", {{"axis", "y"}});
    requests.push_back(client->send("parameter.get", {{"axis", "z"}, {"parameter", 4}}));
  }
  // Some go without waiting for their answers.
  for (std::size_t i = 0; i < clients.size(); i += 2) clients[i]->hang_up();
  for (std::size_t i = 1; i < clients.size(); i += 2) {
    EXPECT_EQ(clients[i]->answer_to(requests[i]).at("result").at("value"), 1000);
  }
}

TEST_F(Tmcld, EndsCleanlyWithinASecond) {
  start_simulator_on_pty();
  write_config(pty_link());
  const auto time_to_end = [&](int signal) {
    start_daemon();
    RpcClient client(socket());
    client.result("axis.rotate", {{"axis", "y"}, {"velocity_internal", 100}});
    const auto waiting = client.send("axis.wait", {{"axis", "y"}});
    client.result("subscribe");
    const auto began = std::chrono::steady_clock::now();
    daemon->signal(signal);
    EXPECT_EQ(daemon->wait(), 0) << daemon->output();
    const auto took = std::chrono::steady_clock::now() - began;
    EXPECT_EQ(text(client.answer_to(waiting).at("error").at("data").at("name")), "link_lost");
    EXPECT_TRUE(client.is_cut_off());
    EXPECT_FALSE(std::filesystem::exists(socket()));
    return took;
  };
  for (const int signal : {SIGTERM, SIGINT}) {
    // A busy computer is late now and then; a daemon that waits for somebody, each time.
    int tries = 5;
    while (time_to_end(signal) >= 1s) ASSERT_GT(--tries, 0);
  }
}

TEST_F(Tmcld, SecondDaemonLeavesTheFirstAlone) {
  start_simulator_on_pty();
  write_config(pty_link());
  start_daemon();
  const auto second = run_program({"tmcld", "--config", config()});
  EXPECT_EQ(second.status, 1);
  EXPECT_THAT(second.output, HasSubstr("another daemon already serves " + socket()));
  RpcClient client(socket());
  EXPECT_EQ(client.result("axis.list").at("axes").as_array().size(), 3U);
}

TEST_F(Tmcld, PutsInOrderWhatItLedWhenItWasKilled) {
  start_simulator_on_pty();
  write_config(pty_link());
  start_daemon();
  {
    RpcClient client(socket());
    client.result("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}});
    client.result("line.move", {{"axes", json::array{"y", "z"}},
                                {"positions_microsteps", json::array{4'000'000, 1'000'000}}});
    daemon->signal(SIGKILL);
    daemon->wait();
  }
  start_daemon();
  for (const char* axis : {"x", "y", "z"})
    ASSERT_TRUE(daemon->wait_for("axis '" + std::string(axis) + "' was stopped"))
        << daemon->output();
  RpcClient client(socket());
  for (const char* axis : {"x", "y", "z"})
    EXPECT_EQ(client.result("axis.get_state", {{"axis", axis}}).at("moving"), false) << axis;
}

TEST_F(Tmcld, MovesNothingThatWasAskedForWhileItWasStopped) {
  start_simulator_on_pty();
  write_config(pty_link());
  start_daemon();
  RpcClient client(socket());
  daemon->signal(SIGSTOP);
  const int asked = client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1000}});
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  daemon->signal(SIGCONT);
  EXPECT_EQ(client.answer_to(asked).at("error").at("data").at("name"), "stale_request");
  EXPECT_EQ(client.result("axis.get_state", {{"axis", "x"}}).at("target_microsteps"), 0);
  ASSERT_TRUE(daemon->wait_for("tmcld stood still for")) << daemon->output();
  client.result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1000}});
}

TEST_F(Tmcld, TakesOverTheSocketOfOneThatWasKilled) {
  start_simulator_on_pty();
  write_config(pty_link());
  start_daemon();
  daemon->signal(SIGKILL);
  daemon->wait();
  EXPECT_TRUE(std::filesystem::exists(socket()));
  start_daemon();
  RpcClient client(socket());
  EXPECT_EQ(client.result("axis.list").at("axes").as_array().size(), 3U);
}

TEST_F(Tmcld, IsFrozenAndItsModulesStopTheirMotors) {
  start_simulator_on_pty();
  write_config(pty_link(), "[[module]]\nbus = \"bench\"\naddress = 1\ndeadman_ms = 300\n");
  start_daemon();
  RpcClient client(socket());
  const auto state = [&] { return client.result("axis.get_state", {{"axis", "x"}}); };
  client.result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 5'000'000}});
  while (!state().at("moving").as_bool()) {
  }
  daemon->signal(SIGSTOP);
  std::this_thread::sleep_for(1s);
  daemon->signal(SIGCONT);
  const auto after = state();
  EXPECT_EQ(after.at("moving"), false);
  EXPECT_LT(after.at("position_microsteps").as_int64(), 5'000'000);
  EXPECT_EQ(after.at("stop_cause"), "deadman");
}

TEST_F(Tmcld, SaysWhatIsMissing) {
  const auto missing = run_program({"tmcld", "--config", path("missing.toml")});
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.output, testing::HasSubstr(path("missing.toml") + ": cannot be read"));
  EXPECT_THAT(missing.output, testing::HasSubstr("tmcld --help"));
  const auto unknown = run_program({"tmcld", "--conf", "x"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.output, testing::HasSubstr("--conf"));
}

TEST_F(Tmcld, SaysAtItsStartThatItCanOpenTooFewFilesForClients) {
  start_simulator_on_pty();
  write_config(pty_link());
  daemon = std::make_unique<Program>(std::vector<std::string>{
      "/bin/sh", "-c", "ulimit -n 32; exec '" TMCL_BIN_DIR "/tmcld' --config '" + config() + "'"});
  ASSERT_TRUE(daemon->wait_for("module_answers (module 1)")) << daemon->output();
  EXPECT_THAT(daemon->output(), testing::HasSubstr("so few files may be open (ulimit -n) that no "
                                                   "client can be served but for stops"));
  EXPECT_TRUE(RpcClient(socket()).call("axis.stop", {{"axis", "x"}}).contains("result"));
}

TEST_F(Tmcld, TakesTheConfigurationOfItsPackageUnlessTold) {
  EXPECT_THAT(run_program({"tmcld", "--help"}).output, testing::HasSubstr("/etc/tmcl/tmcld.toml"));
}

TEST_F(Tmcld, ChecksItsConfiguration) {
  const std::string link = "tcp:127.0.0.1:4001";
  write_config(link);
  const auto good = run_program({"tmcld", "--config", config(), "--check"});
  EXPECT_EQ(good.status, 0);
  EXPECT_EQ(good.output, "ok: 1 bus, 3 axes\n");
  EXPECT_FALSE(std::filesystem::exists(socket()));

  std::filesystem::create_directory(path("tmcld.d"));
  std::ofstream(path("tmcld.d/cell.toml")) << "[[bus]]\nname = \"cell\"\nlink = \"can:can0\"\n";
  EXPECT_EQ(run_program({"tmcld", "--config", config(), "--check"}).output,
            "ok: 2 buses, 3 axes, from 2 files\n");
  std::filesystem::remove_all(path("tmcld.d"));

  std::ofstream(config(), std::ios::app) << "moter = 1\n";
  const auto bad = run_program({"tmcld", "--config", config(), "--check"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_EQ(bad.output,
            config() + ":22:1: unknown key 'moter' in [[axis]]. Did you mean 'motor'?\n");

  write_config(link,
               "unit = \"mm\"\nscrew_pitch = 10\ngear_ratio = 3\nsoft_limits = [-2.5, 300]\n"
               "encoder_lines = 1000\n");
  const auto screw = run_program({"tmcld", "--config", config(), "--check"});
  EXPECT_EQ(screw.output,
            "ok: 1 bus, 3 axes\nz: 10 mm a turn behind a gear of 3:1, from -2.5 to 300 mm, 1200 "
            "encoder counts a mm\n");

  write_config("serial:/dev/none@9600",
               "[[module]]\nbus = \"bench\"\naddress = 1\ndeadman_ms = 600\n");
  const auto fed = run_program({"tmcld", "--config", config(), "--check"});
  EXPECT_EQ(fed.output,
            "ok: 1 bus, 3 axes\nbench: modules with a deadman are sent something often enough, "
            "which takes 9.9 % of the wire at 9600 baud\nbench: the motors of module 1 stop when "
            "one answer is lost: that is made up for with a deadman_ms of 1545 or more, or a "
            "shorter reply_timeout_ms\n");

  // Where replies come with the identifier 2, no module may have it.
  write_config("can:can0");
  const auto can = run_program({"tmcld", "--config", config(), "--check"});
  EXPECT_EQ(can.status, 2);
  EXPECT_THAT(can.output, HasSubstr("axis 'y' has the address 2, but replies"));
  EXPECT_EQ(std::ranges::count(can.output, '\n'), 1) << "once for each module";
}

TEST_F(Tmcld, ExplainsItself) {
  const auto help = run_program({"tmcld", "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.output, HasSubstr("[[axis]]"));
  EXPECT_THAT(run_program({"tmcld", "--version"}).output, HasSubstr("tmcld 0."));
  EXPECT_EQ(run_program({"tmcld"}).status, 2);
  EXPECT_EQ(run_program({"tmcld", "--confg", "x"}).status, 2);
  EXPECT_EQ(run_program({"tmcld", "--config", path("none.toml")}).status, 2);
  std::ofstream(config()) << "[daemon]\nsocket = \"" << path("no/socket") << "\"\n";
  const auto nowhere = run_program({"tmcld", "--config", config()});
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_THAT(nowhere.output, HasSubstr("does not exist; create it"));
}

}  // namespace
}  // namespace tmcl::test
