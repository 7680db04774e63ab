// A bus on CAN: no module may have the identifier of the replies.
#include <gmock/gmock.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

class DaemonCan : public testing::Test {
 protected:
  DaemonCan() {
    daemon.wire().modules.emplace(std::uint8_t{3}, FakeModule(3));
    daemon.wire().modules.emplace(std::uint8_t{9}, FakeModule(9));
    daemon.start();
  }
  void expect_refused(const std::string& method, json::object params, const std::string& why) {
    params["bus"] = "bench";
    const auto before = daemon.requests_seen(tmcl::Command::SGP);
    const auto error = client().error(method, std::move(params));
    EXPECT_EQ(error.at("code"), -32602);
    EXPECT_EQ(text(error.at("data").at("name")), "bad_argument");
    EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent");
    EXPECT_THAT(text(error.at("message")), HasSubstr(why));
    EXPECT_EQ(daemon.requests_seen(tmcl::Command::SGP), before);
  }
  RpcClient& client() {
    if (!client_) client_.emplace(daemon.socket());
    return *client_;
  }

  TestDaemon daemon{"[[bus]]\nname = \"bench\"\nlink = \"can:can0\"\ncan_reply_id = 9\n" +
                    axis_section("x", 0) +
                    "[[axis]]\nname = \"z\"\nbus = \"bench\"\naddress = 3\nmotor = 0\n"};

 private:
  std::optional<RpcClient> client_;
};

TEST_F(DaemonCan, NoIdentifierIsSetToThatOfTheReplies) {
  const auto global = [](int parameter, int value) {
    return json::object{{"address", 1}, {"parameter", parameter}, {"value", value}};
  };
  for (const int listens : {71, 83})
    expect_refused("global.set", global(listens, 9), "9 is the identifier of the replies");
  expect_refused("global.set", global(70, 1), "1 is the address of a module");
  expect_refused("global.set", global(70, 3), "3 is the address of a module");
  const auto raw = [](int type, int value) {
    return json::object{{"address", 1}, {"command", "SGP"}, {"type", type}, {"value", value}};
  };
  expect_refused("module.execute", raw(71, 9), "9 is the identifier of the replies");
  expect_refused("module.execute", raw(70, 3), "3 is the address of a module");
}

TEST_F(DaemonCan, OthersAreSet) {
  const auto set = [&](int parameter, int value, int bank) {
    return client().result("global.set", {{"bus", "bench"},
                                          {"address", 1},
                                          {"parameter", parameter},
                                          {"bank", bank},
                                          {"value", value}});
  };
  EXPECT_EQ(set(71, 5, 0).at("value"), 5);
  EXPECT_EQ(set(70, 5, 0).at("value"), 5);
  EXPECT_EQ(set(71, 9, 2).at("value"), 9) << "a user variable is no identifier";
}

TEST_F(DaemonCan, AScanTellsWhoTakesRepliesForCommands) {
  const auto found = client().result("bus.scan", {{"bus", "bench"}, {"last", 10}});
  const auto& modules = found.at("modules").as_array();
  ASSERT_EQ(modules.size(), 3U);
  EXPECT_EQ(modules.at(1).at("address_is_reply_id"), false);
  EXPECT_EQ(modules.at(2).at("address"), 9);
  EXPECT_EQ(modules.at(2).at("address_is_reply_id"), true);
}

}  // namespace
}  // namespace tmcld::test
