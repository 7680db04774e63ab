// The daemon as systemd starts it: told where to report, and given its socket.
#include <array>
#include <filesystem>
#include <fstream>
#include <set>

#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <gmock/gmock.h>

#include "system/tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

int bound_socket(int type, const std::string& path) {
  const int descriptor = ::socket(AF_UNIX, type | SOCK_CLOEXEC, 0);
  const auto address = address_of(path);
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("cannot bind " + path);
  return descriptor;
}

/// What the test has opened in the place of systemd.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { ::close(number_); }
  operator int() const { return number_; }

 private:
  int number_;
};

class TmcldService : public TmcldTest {
 protected:
  void write_config_without_a_bus() const {
    std::ofstream(config()) << "[daemon]\nsocket = \"" << socket() << "\"\n";
  }
  /// The shell sets what has to be known in the daemon's own process: its number, and descriptor 3.
  void start_as_service(const std::string& setting) {
    const auto script = setting + "; exec \"$0\" --config \"$1\"";
    daemon = std::make_unique<Program>(
        std::vector<std::string>{"/bin/bash", "-c", script, TMCL_BIN_DIR "/tmcld", config()});
  }
  std::string reporting() const { return "export NOTIFY_SOCKET=" + path("notify"); }
  /// 3 is what the test has open with this number.
  static std::string passing(int descriptor) {
    // dup() leaves out close-on-exec, which would keep it from the shell.
    return "exec 3<&" + std::to_string(descriptor) + "; export LISTEN_FDS=1 LISTEN_PID=$$";
  }

  /// The next datagram with this text; empty if none comes for ten seconds.
  std::string told(const std::string& text) const {
    pollfd waiting{manager_, POLLIN, 0};
    while (::poll(&waiting, 1, 10'000) > 0) {
      std::array<char, 512> datagram{};
      const auto size = ::recv(manager_, datagram.data(), datagram.size(), 0);
      const std::string words(datagram.data(),
                              static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
      if (words.find(text) != std::string::npos) return words;
    }
    return {};
  }

 private:
  Descriptor manager_{bound_socket(SOCK_DGRAM, path("notify"))};
};

TEST_F(TmcldService, SaysWhenItServesAndWhenItEnds) {
  write_config_without_a_bus();
  start_as_service(reporting());
  EXPECT_EQ(told("READY=1"), "READY=1\nSTATUS=no bus is configured");
  RpcClient client(socket());
  EXPECT_TRUE(client.result("axis.list").at("axes").as_array().empty());
  daemon->signal(SIGTERM);
  EXPECT_THAT(told("STOPPING=1"), HasSubstr("STATUS=ending"));
  EXPECT_EQ(daemon->wait(), 0) << daemon->output();
}

TEST_F(TmcldService, TellsJournaldTheLevelOfEachLine) {
  write_config_without_a_bus();
  const auto log = path("log");
  start_as_service("exec 2>" + log + "; export JOURNAL_STREAM=$(stat -c %d:%i " + log + "); " +
                   reporting());
  ASSERT_NE(told("READY=1"), "");
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(), 0);
  std::ifstream lines(log);
  std::string line;
  for (; std::getline(lines, line) && line != "<6>ended";) EXPECT_THAT(line, StartsWith("<6>"));
  EXPECT_EQ(line, "<6>ended");
}

TEST_F(TmcldService, FeedsItsWatchdogWhateverBecomesOfItsBuses) {
  start_simulator_on_pty();
  write_config(pty_link());
  start_as_service(reporting() + "; export WATCHDOG_USEC=100000");
  EXPECT_THAT(told("READY=1"), HasSubstr("axes: 3, buses open: 1 of 1"));
  EXPECT_NE(told("WATCHDOG=1"), "");
  EXPECT_NE(told("WATCHDOG=1"), "");
  ASSERT_TRUE(daemon->wait_for("module_answers (module 2)")) << daemon->output();
  simulator->signal(SIGSTOP);
  RpcClient client(socket());
  client.send("parameter.get", {{"axis", "x"}, {"parameter", 4}});
  EXPECT_NE(told("WATCHDOG=1"), "");
  EXPECT_NE(told("WATCHDOG=1"), "");
  simulator.reset();
  EXPECT_EQ(told("0 of 1"), "STATUS=axes: 3, buses open: 0 of 1");
  EXPECT_NE(told("WATCHDOG=1"), "");
}

TEST_F(TmcldService, ServesOnTheSocketThatItIsPassedAndLeavesItThere) {
  write_config_without_a_bus();
  const Descriptor listening(bound_socket(SOCK_STREAM, socket()));
  ASSERT_EQ(::listen(listening, 16), 0);
  const Descriptor for_shell(::dup(listening));
  for (int round = 0; round < 2; ++round) {
    // It has come before anybody serves it, and waits.
    RpcClient early(socket(), false);
    start_as_service(passing(for_shell));
    EXPECT_THAT(early.read_line().value_or("nothing"), HasSubstr("hello"));
    RpcClient client(socket());
    EXPECT_TRUE(client.result("axis.list").at("axes").as_array().empty());
    daemon->signal(SIGTERM);
    EXPECT_EQ(daemon->wait(), 0) << daemon->output();
    EXPECT_TRUE(std::filesystem::exists(socket()));
  }
}

TEST_F(TmcldService, DoesNothingThatWasAskedForBeforeItServed) {
  write_config_without_a_bus();
  const Descriptor listening(bound_socket(SOCK_STREAM, socket()));
  ASSERT_EQ(::listen(listening, 16), 0);
  const Descriptor for_shell(::dup(listening));
  RpcClient early(socket(), false);
  early.send("axis.list");
  start_as_service(passing(for_shell));
  EXPECT_TRUE(early.is_cut_off());
  EXPECT_TRUE(daemon->wait_for("before tmcld served them: 1; nothing")) << daemon->output();
}

TEST_F(TmcldService, RefusesASocketThatClientsWouldNotFind) {
  write_config_without_a_bus();
  const Descriptor listening(bound_socket(SOCK_STREAM, path("elsewhere")));
  ASSERT_EQ(::listen(listening, 16), 0);
  const Descriptor for_shell(::dup(listening));
  start_as_service(passing(for_shell));
  EXPECT_EQ(daemon->wait(), 1);
  EXPECT_THAT(daemon->output(), HasSubstr("clients look for it at " + socket()));
  EXPECT_TRUE(std::filesystem::exists(path("elsewhere")));
}

/// The policies of all threads of a process but its first.
std::multiset<int> policies_of_workers(pid_t process) {
  std::multiset<int> policies;
  const auto folder = "/proc/" + std::to_string(process) + "/task";
  for (const auto& thread : std::filesystem::directory_iterator(folder)) {
    const auto number = std::stoi(thread.path().filename().string());
    if (number != process) policies.insert(::sched_getscheduler(number));
  }
  return policies;
}

TEST_F(TmcldService, KeepsRealTimeForItsReactor) {
  start_simulator_on_pty();
  write_config(pty_link());
  // Where this user may not have it, there is nothing to be given up.
  start_as_service("chrt -r -p 1 $$ || true");
  ASSERT_TRUE(daemon->wait_for("module_answers (module 2)")) << daemon->output();
  const bool may = daemon->output().find("failed to set") == std::string::npos;
  EXPECT_EQ(::sched_getscheduler(daemon->process()), may ? SCHED_RR : SCHED_OTHER);
  const auto workers = policies_of_workers(daemon->process());
  // The log, the audit trail, and who opens links.
  EXPECT_GE(workers.size(), 3U);
  EXPECT_EQ(workers.count(SCHED_OTHER), workers.size());
}

}  // namespace
}  // namespace tmcl::test
