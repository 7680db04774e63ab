// Relays: clients that bring calls of users whom tmcld does not know.
#include "api/relay.hpp"

#include <pwd.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::uint32_t brings_calls = 4003;

Caller relay_up_to(Role role) {
  const std::vector<AccessConfig> access{{role, {{"relay", brings_calls}}, {}, true},
                                         {Role::configure, {{"relay", brings_calls}}, {}}};
  return caller_with({brings_calls, 1, {}}, access);
}

TEST(RelayRights, AreThoseOfTheSectionThatMakesItOne) {
  EXPECT_EQ(relay_up_to(Role::operate).lends, Role::operate);
  EXPECT_EQ(relay_up_to(Role::operate).role, Role::configure);
  EXPECT_EQ(caller_with({brings_calls, 1, {}}, {}).lends, std::nullopt);
  EXPECT_EQ(caller_with({0, 1, {}}, {}).lends, std::nullopt) << "root has to be named, too";
}

TEST(RelayRights, AreNeverAboveItsOwn) {
  const auto relay = relay_up_to(Role::operate);
  for (const auto role : {Role::stop, Role::observe, Role::operate})
    EXPECT_EQ(objection_to_relaying(relay, {"anna", role}), std::nullopt);
  const auto objection = objection_to_relaying(relay, {"anna", Role::configure});
  ASSERT_TRUE(objection);
  EXPECT_EQ(objection->name, "not_permitted");
  EXPECT_EQ(objection->outcome, tmcl::Outcome::not_sent);
  EXPECT_THAT(objection->message, HasSubstr("'configure'"));
  EXPECT_EQ(caller_for({"anna", Role::configure}, relay).role, Role::operate);
}

TEST(RelayRights, EndWithThoseOfTheRelay) {
  const auto caller = caller_for({"anna", Role::operate}, Caller{});
  EXPECT_EQ(caller.role, Role::stop);
  EXPECT_FALSE(caller.exceeds_limits);
  EXPECT_EQ(caller_for({"anna", Role::operate}, relay_up_to(Role::observe)).role, Role::observe);
}

TEST(RelayRights, NamesOfUsersCanStandInALog) {
  for (const auto* name : {"anna", "a.b@c", "A-1_2"}) EXPECT_TRUE(is_relayed_user_name(name));
  for (const auto* name : {"", "anna b", "a\"b", "a\nb", "a/b", "\xC3\xA4"})
    EXPECT_FALSE(is_relayed_user_name(name)) << name;
  EXPECT_TRUE(is_relayed_user_name(std::string(max_relayed_user_bytes, 'a')));
  EXPECT_FALSE(is_relayed_user_name(std::string(max_relayed_user_bytes + 1, 'a')));
}

std::string access_of_this_user(const std::string& more) {
  return "[[access]]\nrole = \"operate\"\nusers = [\"" +
         std::string(::getpwuid(::geteuid())->pw_name) + "\"]\n" + more;
}

class RelayOnASocket : public testing::Test {
 protected:
  static json::object user(std::string_view name, std::string_view role) {
    return {{"user", name}, {"role", role}};
  }
  static std::string refusal(const json::object& error) {
    return std::string(error.at("data").at("name").as_string());
  }

  TestDaemon daemon{access_of_this_user("relay = true\n") + two_axes()};
};

TEST_F(RelayOnASocket, MakesTheCallsOfAConnectionThoseOfItsUser) {
  daemon.start();
  RpcClient client(daemon.socket());
  EXPECT_EQ(client.result("speak_for", user("anna", "observe")), user("anna", "observe"));
  client.result("axis.list");
  const auto error = client.error("axis.move_to", {{"axis", "x"}, {"position_microsteps", 10}});
  EXPECT_EQ(refusal(error), "not_permitted");
  EXPECT_THAT(std::string(error.at("message").as_string()), HasSubstr("'anna'"));
  client.result("axis.stop", {{"axis", "x"}});
}

TEST_F(RelayOnASocket, NamesTheUserAsTheHolderOfALease) {
  daemon.start();
  RpcClient client(daemon.socket());
  client.result("speak_for", user("anna", "operate"));
  client.result("lease.acquire", {{"axes", {"x"}}, {"ttl_ms", 60000}});
  RpcClient other(daemon.socket());
  const auto leases = other.result("lease.list").at("leases").as_array();
  ASSERT_EQ(leases.size(), 1U);
  EXPECT_THAT(std::string(leases.at(0).at("holder").as_string()),
              StartsWith("anna through process "));
  other.result("speak_for", user("ben", "operate"));
  EXPECT_EQ(refusal(other.error("axis.move_to", {{"axis", "x"}, {"position_microsteps", 10}})),
            "leased");
}

TEST_F(RelayOnASocket, IsListedAsItsUserWithThatOnesRole) {
  daemon.start();
  RpcClient client(daemon.socket());
  client.result("speak_for", user("anna", "observe"));
  RpcClient other(daemon.socket());
  const auto clients = other.result("client.list").at("clients").as_array();
  ASSERT_EQ(clients.size(), 2U);
  EXPECT_THAT(std::string(clients.at(0).at("client").as_string()),
              StartsWith("anna through process "));
  EXPECT_EQ(clients.at(0).at("role").as_string(), "observe");
  EXPECT_NE(clients.at(1).at("role").as_string(), "observe");
}

TEST_F(RelayOnASocket, RefusesWhatIsForged) {
  daemon.start();
  RpcClient client(daemon.socket());
  EXPECT_EQ(refusal(client.error("speak_for", user("anna", "configure"))), "not_permitted");
  EXPECT_EQ(refusal(client.error("speak_for", user("anna", "root"))), "bad_argument");
  EXPECT_EQ(refusal(client.error("speak_for", user("an na", "operate"))), "bad_argument");
  client.result("speak_for", user("anna", "observe"));
  const auto error = client.error("speak_for", user("ben", "operate"));
  EXPECT_EQ(refusal(error), "not_permitted");
  EXPECT_THAT(std::string(error.at("message").as_string()), HasSubstr("'anna'"));
}

TEST(NoRelay, SpeaksForNoUser) {
  for (const auto& toml : {two_axes(), access_of_this_user("") + two_axes()}) {
    TestDaemon daemon(toml);
    daemon.start();
    RpcClient client(daemon.socket());
    const auto error = client.error("speak_for", {{"user", "anna"}, {"role", "observe"}});
    EXPECT_EQ(error.at("data").at("name").as_string(), "not_permitted");
    EXPECT_THAT(std::string(error.at("message").as_string()), HasSubstr("no relay"));
  }
}

}  // namespace
}  // namespace tmcld::test
