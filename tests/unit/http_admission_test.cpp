// Who is let in by HTTP: decided by the head of a request, without a socket.
#include "fronts/http_admission.hpp"

#include <gmock/gmock.h>

#include "log/sink.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

class HttpAdmission : public testing::Test {
 protected:
  HttpAdmission() {
    connection.peer = "127.0.0.1:5";
    connection.is_loopback = true;
    connection.port = 4143;
    rules.loopback_without_token = true;
    head.method = "POST";
    head.target = "/rpc";
    head.host = "localhost:4143";
    head.content_type = "application/json";
  }
  /// 0 if it is let in.
  unsigned refusal() {
    const auto entry = admit_http(head, connection, rules, *tokens, access);
    return entry ? 0 : http_status_of(entry.error());
  }
  HttpEntry entry() { return admit_http(head, connection, rules, *tokens, access).value(); }

  HttpHead head;
  HttpConnectionInfo connection;
  HttpRules rules;
  std::vector<AccessConfig> access;
  std::shared_ptr<Tokens> tokens = Tokens::open("", no_log);
};

TEST_F(HttpAdmission, IsByThisComputerOnlyWithoutATokenAndOnlyIfItIsConfigured) {
  EXPECT_EQ(refusal(), 0U);
  EXPECT_EQ(entry().caller.role, Role::configure);
  EXPECT_FALSE(entry().caller.exceeds_limits);
  connection.is_loopback = false;
  EXPECT_EQ(refusal(), 401U);
  connection.is_loopback = true;
  rules.loopback_without_token = false;
  EXPECT_EQ(refusal(), 401U);
}

TEST_F(HttpAdmission, NeedsTheNameOfThisComputerWithoutAToken) {
  for (const auto* good : {"127.0.0.1:4143", "[::1]:4143", "LocalHost:4143"}) {
    head.host = good;
    EXPECT_EQ(refusal(), 0U) << good;
  }
  for (const auto* bad : {"", "evil.example:4143", "localhost", "localhost:4144",
                          "localhost.evil.example:4143", "127.0.0.1.evil.example:4143"}) {
    head.host = bad;
    EXPECT_EQ(refusal(), 403U) << bad;
  }
}

TEST_F(HttpAdmission, TakesNoPageOfSomebodyElseEvenWithAToken) {
  const auto secret = "Bearer " + tokens->add("a", Role::operate);
  for (const auto& authorization : {std::string(), secret}) {
    head.authorization = authorization;
    head.origin = "http://localhost:4143";
    EXPECT_EQ(refusal(), 0U);
    for (const auto* foreign : {"null", "http://evil.example", "https://localhost:4143", ""}) {
      head.origin = foreign;
      EXPECT_EQ(refusal(), 403U) << foreign;
    }
  }
}

TEST_F(HttpAdmission, TakesPagesThatTheConfigurationNames) {
  const std::vector<std::string> origins{"https://bench.example"};
  rules.origins = origins;
  head.origin = "https://bench.example";
  EXPECT_EQ(refusal(), 0U);
  head.origin = "https://bench.example.evil.example";
  EXPECT_EQ(refusal(), 403U);
}

TEST_F(HttpAdmission, GivesTheRoleOfTheToken) {
  const auto secret = "Bearer " + tokens->add("bench", Role::observe);
  rules.loopback_without_token = false;
  connection.is_loopback = false;
  head.authorization = secret;
  const auto let_in = entry();
  EXPECT_EQ(let_in.caller.role, Role::observe);
  EXPECT_EQ(let_in.token, "bench");
  EXPECT_THAT(let_in.name, HasSubstr("'bench' from 127.0.0.1:5"));
  tokens->remove("bench");
  EXPECT_EQ(refusal(), 401U);
}

TEST_F(HttpAdmission, DoesNotFallBackToNoTokenForAWrongOne) {
  head.authorization = "Bearer tmcl_0";
  EXPECT_EQ(refusal(), 401U);
}

TEST_F(HttpAdmission, FindsTheTokenOfABrowserAmongTheProtocols) {
  const auto protocols = "tmcl, bearer." + tokens->add("page", Role::operate);
  rules.loopback_without_token = false;
  head.method = "GET";
  head.target = "/ws";
  head.is_upgrade = true;
  head.protocols = protocols;
  EXPECT_EQ(entry().token, "page");
  EXPECT_EQ(entry().protocol, "tmcl");
  EXPECT_EQ(entry().route, HttpRoute::websocket);
}

TEST_F(HttpAdmission, GivesNobodyARoleByUsersAndGroupsWithoutAToken) {
  access.push_back({Role::configure, {{"anna", 1000}}, {}});
  EXPECT_EQ(entry().caller.role, Role::stop);
}

TEST_F(HttpAdmission, TakesACallAsJsonOnly) {
  head.content_type = "Application/JSON; charset=utf-8";
  EXPECT_EQ(refusal(), 0U);
  for (const auto* other : {"", "text/plain", "application/x-www-form-urlencoded"}) {
    head.content_type = other;
    EXPECT_EQ(refusal(), 415U) << other;
  }
}

TEST_F(HttpAdmission, DoesNotFallBackToNoTokenForACookieThatHasEnded) {
  head.cookies = "a=b; tmcl-4143=0123";
  EXPECT_EQ(refusal(), 401U);
  head.cookies = "a=b";
  EXPECT_EQ(refusal(), 0U);
}

TEST_F(HttpAdmission, NamesTheCookieOfATlsPortSoThatNoOtherHostSetsIt) {
  head.cookies = "tmcl-4143=1; __Host-tmcl-4143=2; __Host-tmcl-4144=3";
  EXPECT_EQ(cookie_of(head, connection), "1");
  connection.has_tls = true;
  EXPECT_EQ(cookie_of(head, connection), "2");
}

TEST_F(HttpAdmission, SaysWhatIsWhere) {
  head.method = "GET";
  EXPECT_EQ(refusal(), 405U);
  head.target = "/ws";
  EXPECT_EQ(refusal(), 426U);
  head.target = "/../etc/passwd";
  EXPECT_EQ(refusal(), 404U);
  rules.loopback_without_token = false;
  head.target = "/healthz";
  EXPECT_EQ(refusal(), 0U);
  head.target = "/metrics";
  EXPECT_EQ(refusal(), 401U);
}

}  // namespace
}  // namespace tmcld::test
