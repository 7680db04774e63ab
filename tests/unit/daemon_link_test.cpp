// Links that are not there, go, and come back; and how a daemon begins and ends.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;

using DaemonLink = DaemonTest;

std::string bus_state(RpcClient& client) {
  return text(client.result("bus.list").at("buses").as_array().at(0).at("state"));
}

// Whoever starts the daemon and calls it in the next line finds its buses open.
TEST(DaemonStart, GreetsItsClientsWhenItsBusesAreOpen) {
  constexpr auto longest = std::chrono::milliseconds(300);
  TestDaemon daemon;
  daemon.wire().is_absent = true;
  const auto& bus = *daemon.daemon().gateway().buses()[0];
  const auto begin = daemon.now();
  daemon.start(false);
  ASSERT_TRUE(daemon.eventually([&] { return !bus.error().empty(); }));
  daemon.wire().is_absent = false;
  RpcClient client(daemon.socket());
  const bool is_open = bus_state(client) == "open";
  EXPECT_TRUE(is_open || daemon.now() - begin >= longest);
}

TEST_F(DaemonLink, IsLostAndComesBack) {
  client.result("subscribe", {{"axes", json::array{"x"}}});
  daemon.on_reactor([&] {
    daemon.wire().is_absent = true;
    return daemon.wire().unplug(), 0;
  });
  EXPECT_EQ(text(client.notification("notify_event").at("kind")), "link_lost");
  const auto error =
      client.error("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}}).at("data");
  EXPECT_EQ(text(error.at("name")), "link_lost");
  EXPECT_EQ(text(error.at("outcome")), "not_sent");
  EXPECT_EQ(bus_state(client), "lost");
  const auto stopped = client.result("system.stop_all");
  // The module has a motor besides these.
  EXPECT_EQ(stopped.at("failed").as_array().size(), 3U);

  daemon.on_reactor([&] { return daemon.wire().is_absent.exchange(false); });
  EXPECT_EQ(text(client.notification("notify_event").at("kind")), "link_restored");
  EXPECT_EQ(bus_state(client), "open");
  EXPECT_TRUE(client.result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}})
                  .contains("target_microsteps"));
}

TEST_F(DaemonLink, ComesBackAsAnotherModuleThatIsAskedBeforeItIsMoved) {
  const auto questions = daemon.requests_seen(Command::GET_FIRMWARE_VERSION);
  daemon.on_reactor([&] { return daemon.wire().unplug(), 0; });
  // Until the loss is noticed everything looks as before: the question comes first.
  EXPECT_TRUE(daemon.eventually([&] {
    return daemon.wire().count(Command::GET_FIRMWARE_VERSION) > questions &&
           daemon.daemon().gateway().buses()[0]->state() == GatewayBus::State::open &&
           daemon.daemon().gateway().axes()[0]->module().state() == GatewayModule::State::ready;
  }));
}

TEST_F(DaemonLink, EndsWhatIsInProgressWithHowFarItGot) {
  daemon.on_reactor([&] { return daemon.wire().holds = true; });
  const auto sent =
      client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}, {"predict", false}});
  ASSERT_TRUE(daemon.eventually([&] { return !daemon.wire().held.empty(); }));
  const auto queued =
      client.send("axis.move_to", {{"axis", "y"}, {"position_microsteps", 1}, {"predict", false}});
  client.result("axis.list");  // the daemon has taken it in
  daemon.on_reactor([&] { return daemon.wire().unplug(), 0; });
  EXPECT_EQ(text(client.answer_to(sent).at("error").at("data").at("outcome")), "unknown");
  EXPECT_EQ(text(client.answer_to(queued).at("error").at("data").at("outcome")), "not_sent");
}

TEST_F(DaemonLink, SilentModuleIsFoundAgain) {
  client.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 60000}});
  daemon.on_reactor([&] { return daemon.wire().modules.clear(), 0; });
  const auto error = client.error("axis.get_state", {{"axis", "x"}}).at("data");
  EXPECT_THAT(text(error.at("name")), testing::AnyOf("reply_timeout", "module_silent"));
  EXPECT_EQ(text(client.notification("notify_event").at("kind")), "module_silent");
  // A movement is not sent to a module that has to say first what it is.
  const auto move =
      client.error("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}}).at("data");
  EXPECT_EQ(text(move.at("outcome")), "not_sent");
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 0U);
  EXPECT_EQ(text(client.result("axis.list").at("axes").as_array().at(0).at("state")), "silent");
  daemon.on_reactor([&] { return daemon.wire().modules.emplace(1, FakeModule(1)).second; });
  EXPECT_EQ(text(client.notification("notify_event").at("kind")), "module_answers");
}

TEST(DaemonLinkMissing, IsToldAndDoesNotKeepOthersWaiting) {
  TestDaemon daemon(two_axes() + R"(
[[bus]]
name = "other"
link = "serial:/dev/none2"
[[axis]]
name = "z"
bus = "other"
address = 1
motor = 9
)");
  daemon.wire("other").is_absent = true;
  daemon.start(false);
  RpcClient client(daemon.socket());
  ASSERT_TRUE(daemon.eventually([&] {
    const auto& gateway = daemon.daemon().gateway();
    return !gateway.buses()[1]->error().empty() &&
           gateway.axes()[0]->module().state() == GatewayModule::State::ready;
  }));
  const auto bus = client.result("bus.list").at("buses").as_array().at(1);
  EXPECT_EQ(text(bus.at("state")), "opening");
  EXPECT_THAT(text(bus.at("error")), HasSubstr("no such device"));
  EXPECT_EQ(client.result("axis.get_state", {{"axis", "x"}}).at("axis"), "x");

  daemon.on_reactor([&] { return daemon.wire("other").is_absent.exchange(false); });
  ASSERT_TRUE(daemon.eventually([&] {
    return daemon.daemon().gateway().axes()[2]->module().state() == GatewayModule::State::ready;
  }));
  EXPECT_EQ(text(client.result("axis.list").at("axes").as_array().at(2).at("state")),
            "no_such_motor");
  const auto error = client.error("axis.move_to", {{"axis", "z"}, {"position_microsteps", 1}});
  EXPECT_THAT(text(error.at("message")), HasSubstr("motor 9, but a TMCM-3110 has 3"));
  EXPECT_EQ(daemon.on_reactor([&] { return daemon.wire("other").count(Command::MVP); }), 0U);
}

TEST(DaemonModel, UnknownWorksByNumber) {
  TestDaemon daemon;
  daemon.wire().model = 9999;
  daemon.start();
  RpcClient client(daemon.socket());
  const auto module = client.result("module.list").at("modules").as_array().at(0);
  EXPECT_TRUE(module.at("model").is_null());
  EXPECT_EQ(module.at("model_number"), 9999);
  EXPECT_EQ(module.at("axes"), 3);
  EXPECT_EQ(client.result("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 70000}})
                .at("value"),
            70000);
  EXPECT_EQ(text(client.error("parameter.get", {{"axis", "x"}, {"parameter", "max_velocity"}})
                     .at("data")
                     .at("name")),
            "unknown_parameter");
  EXPECT_TRUE(client.result("axis.get_state", {{"axis", "x"}}).at("velocity_pps").is_null());
  EXPECT_EQ(client.result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 9'000'000}})
                .at("target_microsteps"),
            9'000'000);
}

// ---- beginning and ending ----------------------------------------------------------------------

TEST(DaemonEnd, TakesASecondAndAnswersWhatIsQueued) {
  TestDaemon daemon("on_exit = \"keep\"\n" + two_axes());
  daemon.start();
  RpcClient client(daemon.socket());
  daemon.on_reactor([&] { return daemon.wire().holds = true; });
  const auto sent =
      client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}, {"predict", false}});
  ASSERT_TRUE(daemon.eventually([&] { return !daemon.wire().held.empty(); }));
  const auto queued =
      client.send("axis.move_to", {{"axis", "y"}, {"position_microsteps", 1}, {"predict", false}});
  client.result("axis.list");
  const auto began = daemon.now();
  daemon.end();
  EXPECT_LT(daemon.now() - began, std::chrono::seconds(1));
  EXPECT_EQ(text(client.answer_to(sent).at("error").at("data").at("outcome")), "unknown");
  EXPECT_EQ(text(client.answer_to(queued).at("error").at("data").at("outcome")), "not_sent");
  EXPECT_TRUE(client.is_cut_off());
  EXPECT_FALSE(std::filesystem::exists(daemon.socket().path));
  EXPECT_FALSE(std::filesystem::exists(daemon.socket().path + ".lock"));
}

TEST_F(DaemonLink, SocketIsForOwnerAndGroup) {
  struct stat status {};
  ASSERT_EQ(::stat(daemon.socket().path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0660U);
}

TEST_F(DaemonLink, NobodyElseCanLockTheSocket) {
  struct stat status {};
  ASSERT_EQ(::stat((daemon.socket().path + ".lock").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0600U);
}

TEST_F(DaemonLink, SocketIsNotTakenFromADaemonThatLives) {
  const auto second = SocketFile::claim(daemon.socket().path);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error(), HasSubstr("another daemon already serves"));
  EXPECT_EQ(client.result("axis.list").at("axes").as_array().size(), 2U);
}

class SocketPath : public testing::Test {
 protected:
  SocketPath() {
    auto name = (std::filesystem::temp_directory_path() / "tmcld-XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~SocketPath() override { std::filesystem::remove_all(folder); }
  std::string folder;
};

TEST_F(SocketPath, StaleSocketIsReplaced) {
  const auto path = folder + "/s";
  {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int left = ::socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(::bind(left, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ::close(left);
  }
  EXPECT_TRUE(SocketFile::claim(path));
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(SocketPath, LiveSocketOfAnotherProgramIsLeftAlone) {
  const auto path = folder + "/s";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int live = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(live, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(live, 1), 0);
  const auto claimed = SocketFile::claim(path);
  ASSERT_FALSE(claimed);
  EXPECT_THAT(claimed.error(), HasSubstr("another daemon already serves"));
  ::close(live);
}

TEST_F(SocketPath, OtherFilesAreLeftAlone) {
  const auto path = folder + "/s";
  std::ofstream(path) << "precious";
  const auto claimed = SocketFile::claim(path);
  ASSERT_FALSE(claimed);
  EXPECT_THAT(claimed.error(), HasSubstr("is no socket"));
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST_F(SocketPath, MissingDirectoryIsToldWithWhatToTry) {
  const auto claimed = SocketFile::claim(folder + "/run/s");
  ASSERT_FALSE(claimed);
  EXPECT_THAT(claimed.error(), HasSubstr("install -d"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/run"));
}

}  // namespace
}  // namespace tmcld::test
