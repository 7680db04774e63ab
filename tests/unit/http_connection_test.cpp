// What a connection by HTTP takes for a request, whose it is, and when it ends: real sockets, and
// modules that the test plays.
#include "fronts/http_connection.hpp"

#include <array>
#include <optional>
#include <sstream>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

#include <gmock/gmock.h>

#include "fronts/http_connections.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using tmcl::Command;
using Tcp = boost::asio::ip::tcp;

std::string sized(const std::string& head, const std::string& body) {
  return head + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::string chunked(const std::string& head, const std::string& body) {
  std::ostringstream size;
  size << std::hex << body.size();
  return head + "Transfer-Encoding: chunked\r\n\r\n" + size.str() + "\r\n" + body + "\r\n0\r\n\r\n";
}

class HttpClient : public testing::Test {
 protected:
  static constexpr std::uint16_t port = 4143;

  HttpClient() {
    share->tokens = Tokens::open("", no_log);
    HttpConfig config;
    config.loopback_without_token = true;
    connections = std::make_shared<HttpConnections>(executor(), gateway(), share, config, 16);
    connect();
  }
  ~HttpClient() override {
    for (const auto& one : connections->all()) one->close();
    bench.time.run_for(1s);
  }

  boost::asio::any_io_executor executor() { return bench.gateway().buses().front()->executor(); }
  std::shared_ptr<Gateway> gateway() { return bench.gateway().shared_from_this(); }

  void connect() {
    Tcp::acceptor acceptor(executor(), {boost::asio::ip::address_v4::loopback(), 0});
    client.emplace(executor());
    client->connect(acceptor.local_endpoint());
    client->non_blocking(true);
    HttpConnectionInfo info{"127.0.0.1:5", "127.0.0.1", true, false, port};
    begin_http_connection(acceptor.accept(), nullptr, std::move(info), connections);
  }

  static std::string head_of(const std::string& line, const std::string& more = {}) {
    return line + " HTTP/1.1\r\nHost: localhost:" + std::to_string(port) + "\r\n" + more;
  }
  static std::string call(const std::string& method, const std::string& params,
                          const std::string& more = {}) {
    return sized(
        head_of("POST /rpc", "Content-Type: application/json\r\n" + more),
        R"({"jsonrpc":"2.0","id":1,"method":")" + method + R"(","params":)" + params + "}");
  }
  static std::string move(const std::string& more = {}) {
    return call("axis.move_to", R"({"axis":"x","position_microsteps":500})", more);
  }

  void send(const std::string& text) {
    boost::asio::write(*client, boost::asio::buffer(text));
    work();
  }
  /// What the daemon does now, and in a moment.
  void work(tmcl::Duration moment = 50ms) {
    // The kernel passes on what is written to a socket when it gets to it.
    for (int i = 0; i < 20; ++i) bench.time.run_for(moment / 20);
    std::array<char, 65536> bytes{};
    boost::system::error_code error;
    while (!error) said.append(bytes.data(), client->read_some(boost::asio::buffer(bytes), error));
    is_closed = error != boost::asio::error::would_block;
  }
  void work_until_closed() {
    for (int i = 0; i < 200 && !is_closed; ++i) work();
    EXPECT_TRUE(is_closed) << said;
  }
  std::size_t answers() const {
    std::size_t count = 0;
    for (auto at = said.find("HTTP/1.1 "); at != std::string::npos;
         at = said.find("HTTP/1.1 ", at + 1))
      ++count;
    return count;
  }
  std::string ask(const std::string& text) {
    said.clear();
    send(text);
    for (int i = 0; i < 200 && said.empty() && !is_closed; ++i) work();
    return said;
  }

  VirtualGateway bench;
  std::shared_ptr<FrontShare> share = std::make_shared<FrontShare>();
  std::shared_ptr<HttpConnections> connections;
  std::optional<Tcp::socket> client;
  std::string said;
  bool is_closed = false;
};

// ---- where a request ends ----------------------------------------------------------------------

TEST_F(HttpClient, IsAnsweredOnceWhateverStandsInTheBodyOfARequest) {
  const std::string upgrade =
      "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n";
  for (const auto* line : {"GET /healthz", "GET /metrics", "GET /ws", "GET /rpc", "GET /nothing",
                           "POST /healthz", "POST /metrics", "PUT /rpc", "OPTIONS /rpc",
                           "HEAD /healthz", "DELETE /metrics", "GET /healthz?x", "GET /", "HEAD /",
                           "POST /", "GET /session", "POST /session", "DELETE /session"}) {
    for (const auto& with : {sized, chunked}) {
      said.clear();
      connect();
      send(with(head_of(line, line == std::string("GET /ws") ? upgrade : ""), move()));
      client->shutdown(Tcp::socket::shutdown_send);
      work_until_closed();
      EXPECT_EQ(answers(), 1U) << line << "\n" << said;
      EXPECT_THAT(said, StartsWith("HTTP/1.1 4")) << line;
    }
  }
  EXPECT_EQ(bench.wire.count(Command::MVP), 0U);
}

TEST_F(HttpClient, MayAskForMoreBehindARequestWithoutABody) {
  send(head_of("GET /healthz", "\r\n") + head_of("GET /healthz", "Content-Length: 0\r\n\r\n"));
  work();
  EXPECT_EQ(answers(), 2U) << said;
  EXPECT_FALSE(is_closed);
}

TEST_F(HttpClient, SendsEachFieldOnOneLineAndWhoItIsOnce) {
  for (const auto* bad : {"Host: localhost:4143\r\n", "Host: evil\r\n", "X: 1\r\n 2\r\n",
                          "X: 1\r\n\t2\r\n", "X:\r\n 1\r\n", "Transfer-Encoding:\r\n chunked\r\n",
                          "Authorization: Bearer a\r\nAuthorization: Bearer b\r\n",
                          "Content-Type: text/plain\r\nContent-Type: application/json\r\n",
                          "Origin: http://localhost:4143\r\nOrigin: http://evil\r\n"}) {
    connect();
    said.clear();
    send(head_of("GET /healthz", bad + std::string("\r\n")));
    client->shutdown(Tcp::socket::shutdown_send);
    work_until_closed();
    EXPECT_THAT(said, AllOf(StartsWith("HTTP/1.1 400"), HasSubstr("bad_head"))) << bad;
  }
  connect();
  EXPECT_THAT(ask(head_of("GET /healthz", "X:\r\nY: 1\r\nY: 2\r\nAccept: a, b\r\n\r\n")),
              StartsWith("HTTP/1.1 200"));
}

// ---- whose it is -------------------------------------------------------------------------------

TEST_F(HttpClient, MovesNothingByATokenThatIsRevokedBeforeTheBodyHasCome) {
  const auto secret = share->tokens->add("bench", Role::operate);
  const auto text = move("Authorization: Bearer " + secret + "\r\n");
  const auto half = text.size() - 10;
  send(text.substr(0, half));
  share->tokens->remove("bench");
  EXPECT_THAT(ask(text.substr(half)), StartsWith("HTTP/1.1 401"));
  EXPECT_EQ(bench.wire.count(Command::MVP), 0U);
}

class HttpRoles : public HttpClient {
 protected:
  /// As a reload does.
  void take_over(const std::string& access) {
    const auto config = parse_config("[daemon]\nsocket = \"/none\"\n" + two_axes() + access);
    ASSERT_TRUE(config);
    bench.gateway().adopt(*config);
    for (const auto& one : connections->all()) one->end_if_it_lost_rights();
    work();
  }
  const std::string for_root = "[[access]]\nrole = \"operate\"\nusers = [\"root\"]\n";
};

TEST_F(HttpRoles, AreThoseOfTheConfigurationAsItIsNow) {
  EXPECT_THAT(ask(move()), HasSubstr("\"result\""));
  take_over(for_root);
  EXPECT_TRUE(is_closed) << "its client may only stop by now";
  connect();
  EXPECT_THAT(ask(move()), HasSubstr("not_permitted"));
  take_over("");
  EXPECT_FALSE(is_closed);
  EXPECT_THAT(ask(move()), HasSubstr("\"result\""));
}

TEST_F(HttpRoles, AreThoseOfWhenTheBodyHasCome) {
  const auto text = move();
  send(text.substr(0, text.size() - 10));
  take_over(for_root);
  EXPECT_THAT(ask(text.substr(text.size() - 10)), HasSubstr("not_permitted"));
}

TEST_F(HttpRoles, EndWhatIsWaitingToBeSent) {
  ask(call("axis.get_state", R"({"axis":"x"})"));
  bench.wire.holds = true;
  send(move());
  take_over(for_root);
  bench.wire.holds = false;
  bench.wire.release();
  work(1s);
  EXPECT_EQ(bench.wire.count(Command::MVP), 0U);
}

// ---- a browser that has signed in --------------------------------------------------------------

class HttpSignIn : public HttpClient {
 protected:
  HttpSignIn() {
    HttpConfig config;
    connections = std::make_shared<HttpConnections>(executor(), gateway(), share, config, 16);
    connect();
  }
  /// The cookie; empty if it was refused.
  std::string sign_in(const std::string& token) {
    ask(head_of("POST /session", "Authorization: Bearer " + token + "\r\n\r\n"));
    const std::string_view field = "Set-Cookie: ";
    const auto at = said.find(field);
    if (at == std::string::npos) return {};
    const auto begin = at + field.size();
    return said.substr(begin, said.find(';', begin) - begin);
  }
  static std::string with(const std::string& cookie) { return "Cookie: " + cookie + "\r\n"; }
  std::string sign_out(const std::string& cookie) {
    connect();
    return ask(head_of("DELETE /session", with(cookie) + "\r\n"));
  }
};

TEST_F(HttpSignIn, GivesACookieThatIsNotTheTokenAndThatNoScriptReads) {
  const auto token = share->tokens->add("bench", Role::operate);
  const auto cookie = sign_in(token);
  EXPECT_THAT(said, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\"role\":\"operate\""),
                          HasSubstr("; HttpOnly; SameSite=Strict")));
  EXPECT_THAT(cookie, AllOf(StartsWith("tmcl-4143="), testing::Not(HasSubstr(token.substr(5)))));
  EXPECT_THAT(ask(move(with(cookie))), HasSubstr("\"result\""));
  EXPECT_NE(sign_in(token), cookie);
}

TEST_F(HttpSignIn, NeedsATokenInItsHead) {
  EXPECT_EQ(sign_in("tmcl_0"), "");
  EXPECT_THAT(said, AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("unknown_token")));
  const auto cookie = (connect(), sign_in(share->tokens->add("bench", Role::operate)));
  connect();
  EXPECT_THAT(ask(head_of("POST /session", with(cookie) + "\r\n")),
              AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("no_token")));
}

TEST_F(HttpSignIn, HasTheRoleOfItsToken) {
  const auto cookie = sign_in(share->tokens->add("guest", Role::observe));
  EXPECT_THAT(ask(move(with(cookie))), HasSubstr("not_permitted"));
  EXPECT_THAT(ask(call("axis.stop", R"({"axis":"x"})", with(cookie))), HasSubstr("\"result\""));
}

TEST_F(HttpSignIn, IsNotForPagesOfOthers) {
  const auto cookie = sign_in(share->tokens->add("bench", Role::operate));
  for (const auto* origin : {"http://localhost:8080", "http://evil.example", "null"}) {
    connect();
    EXPECT_THAT(ask(move(with(cookie) + "Origin: " + origin + "\r\n")),
                AllOf(StartsWith("HTTP/1.1 403"), HasSubstr("foreign_origin")))
        << origin;
  }
  connect();
  EXPECT_THAT(ask(move(with(cookie) + "Origin: http://localhost:4143\r\n")),
              HasSubstr("\"result\""));
}

TEST_F(HttpSignIn, OpensAWebSocketForItsOwnPagesAlone) {
  const auto cookie = sign_in(share->tokens->add("bench", Role::operate));
  const auto upgrade = [&](const std::string& origin) {
    connect();
    return ask(head_of("GET /ws", with(cookie) + "Origin: " + origin +
                                      "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                      "Sec-WebSocket-Version: 13\r\n"
                                      "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n\r\n"));
  };
  EXPECT_THAT(upgrade("http://evil.example"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(upgrade("http://localhost:4143"), StartsWith("HTTP/1.1 101"));
  said.clear();
  connections->sign_out(1);
  work();
  EXPECT_THAT(said, HasSubstr("the sign-in has ended"));
}

TEST_F(HttpSignIn, TakesNoCookieThatItHasNotGiven) {
  sign_in(share->tokens->add("bench", Role::operate));
  for (const auto* bad : {"tmcl-4143=0", "tmcl-4143=", "tmcl-4144=0", "a=b", "tmcl-4143", ";;="}) {
    connect();
    EXPECT_THAT(ask(move(with(bad))), StartsWith("HTTP/1.1 401")) << bad;
  }
  connect();
  EXPECT_THAT(ask(move("Cookie: a=b\r\nCookie: c=d\r\n")), HasSubstr("bad_head"));
}

TEST_F(HttpSignIn, EndsWithItsToken) {
  const auto cookie = sign_in(share->tokens->add("bench", Role::operate));
  share->tokens->on_removed([this](const auto& name) { connections->end_by_token(name); });
  share->tokens->remove("bench");
  share->tokens->add("bench", Role::configure);
  connect();
  EXPECT_THAT(ask(move(with(cookie))), HasSubstr("sign_in_ended"));
}

using HttpInvitation = HttpSignIn;

TEST_F(HttpInvitation, SignsInOnceWithTheRoleOfItsToken) {
  share->tokens->add("phone", Role::observe);
  const auto code = share->tokens->invitations().add("phone", bench.time.now());
  const auto cookie = sign_in(code);
  EXPECT_THAT(said, HasSubstr("\"role\":\"observe\",\"token\":\"phone\""));
  EXPECT_THAT(ask(call("axis.stop", R"({"axis":"x"})", with(cookie))), HasSubstr("\"result\""));
  connect();
  EXPECT_EQ(sign_in(code), "");
  EXPECT_THAT(said, AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("unknown_token")));
}

TEST_F(HttpInvitation, IsNoToken) {
  share->tokens->add("phone", Role::operate);
  const auto code = share->tokens->invitations().add("phone", bench.time.now());
  EXPECT_THAT(ask(move("Authorization: Bearer " + code + "\r\n")), HasSubstr("unknown_token"));
  connect();
  EXPECT_THAT(ask(head_of("GET /session", "Authorization: Bearer " + code + "\r\n\r\n")),
              HasSubstr("unknown_token"));
  connect();
  EXPECT_NE(sign_in(code), "") << "what refused it has not used it";
}

TEST_F(HttpInvitation, EndsByTimeWithItsTokenAndWhenThereAreManyOthers) {
  auto& invitations = share->tokens->invitations();
  share->tokens->add("phone", Role::operate);
  const auto old = invitations.add("phone", bench.time.now());
  bench.time.run_for(time_invited);
  EXPECT_EQ(sign_in(old), "");
  const auto gone = invitations.add("phone", bench.time.now());
  share->tokens->remove("phone");
  share->tokens->add("phone", Role::operate);
  connect();
  EXPECT_EQ(sign_in(gone), "");
  const auto first = invitations.add("phone", bench.time.now());
  const auto second = invitations.add("phone", bench.time.now());
  for (std::size_t i = 1; i < most_invitations; ++i) invitations.add("phone", bench.time.now());
  connect();
  EXPECT_EQ(sign_in(first), "");
  connect();
  EXPECT_NE(sign_in(second), "");
}

TEST_F(HttpSignIn, EndsWithItsDay) {
  const auto cookie = sign_in(share->tokens->add("bench", Role::operate));
  ask(call("axis.rotate", R"({"axis":"x","velocity_internal":100})", with(cookie)));
  bench.time.run_for(time_signed_in);
  connections->end_what_has_expired();
  work_until_closed();
  EXPECT_GE(bench.wire.count(Command::MST), 1U) << "what it has let turn";
  connect();
  EXPECT_THAT(ask(move(with(cookie))), HasSubstr("sign_in_ended"));
}

TEST_F(HttpSignIn, EndsWithASignOut) {
  const auto token = share->tokens->add("bench", Role::operate);
  const auto cookie = sign_in(token);
  const auto other = sign_in(token);
  EXPECT_THAT(sign_out(cookie), AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("tmcl-4143=; Path=/; "
                                                                            "Max-Age=0")));
  connect();
  EXPECT_THAT(ask(move(with(cookie))), HasSubstr("sign_in_ended"));
  EXPECT_THAT(sign_out(cookie), StartsWith("HTTP/1.1 200")) << "so that the cookie goes";
  connect();
  EXPECT_THAT(ask(move(with(other))), HasSubstr("\"result\""));
}

TEST_F(HttpSignIn, GivesWayToTheNextOnesOfItsToken) {
  SignIns all;
  const auto now = tmcl::TimePoint{};
  const auto other = all.add("other", now);
  const auto first = all.add("bench", now);
  for (std::size_t i = 1; i < most_sign_ins_of_a_token; ++i) all.add("bench", now);
  EXPECT_TRUE(all.of_secret(first, now));
  const auto last = all.add("bench", now);
  EXPECT_FALSE(all.of_secret(first, now));
  EXPECT_TRUE(all.of_secret(last, now));
  EXPECT_TRUE(all.of_secret(other, now));
  EXPECT_FALSE(all.of_secret("", now));
}

// ---- when it ends ------------------------------------------------------------------------------

TEST_F(HttpClient, IsNotIdleWhileSomethingIsLeasedByIt) {
  const auto later = [&] { return bench.gateway().clock().now() + 61s; };
  const auto look = [&] {
    for (const auto& one : connections->all()) one->end_if_idle(later());
    work();
  };
  EXPECT_THAT(ask(call("lease.acquire", R"({"axes":["x"],"ttl_ms":60000})")), HasSubstr("epoch"));
  look();
  EXPECT_FALSE(is_closed);
  bench.call("lease.break", {{"axis", "x"}});
  look();
  EXPECT_TRUE(is_closed);
}

TEST_F(HttpClient, IsNotIdleWhileSomethingTurnsByIt) {
  const auto look = [&] {
    for (const auto& one : connections->all())
      one->end_if_idle(bench.gateway().clock().now() + 61s);
    work();
  };
  ask(call("axis.rotate", R"({"axis":"x","velocity_internal":100})"));
  look();
  EXPECT_FALSE(is_closed);
  ask(call("axis.stop", R"({"axis":"x"})"));
  look();
  EXPECT_TRUE(is_closed);
}

TEST_F(HttpClient, EndsWithWhatItHasSetTurning) {
  ask(call("axis.rotate", R"({"axis":"x","velocity_internal":100})", "Connection: close\r\n"));
  work_until_closed();
  work();
  EXPECT_EQ(bench.wire.count(Command::ROR), 1U);
  EXPECT_GE(bench.wire.count(Command::MST), 1U);
}

TEST_F(HttpClient, MayEndItsOutputAndReadTheAnswer) {
  bench.wire.holds = true;
  send(call("axis.get_state", R"({"axis":"x"})"));
  client->shutdown(Tcp::socket::shutdown_send);
  work(400ms);
  EXPECT_FALSE(is_closed);
  EXPECT_THAT(said, HasSubstr("102 Processing"));
  bench.wire.holds = false;
  bench.wire.release();
  work_until_closed();
  EXPECT_THAT(said, HasSubstr("HTTP/1.1 200"));
}

TEST_F(HttpClient, IsGoneWhenItHasClosedItsConnection) {
  bench.wire.holds = true;
  send(call("axis.get_state", R"({"axis":"x"})"));
  ASSERT_EQ(connections->size(), 1U);
  client->close();
  for (int i = 0; i < 200 && connections->size() > 0; ++i) bench.time.run_for(100ms);
  EXPECT_EQ(connections->size(), 0U) << "although there is no answer yet";
}

// ---- WebSocket ---------------------------------------------------------------------------------

class HttpWebSocket : public HttpClient {
 protected:
  static std::string upgrade() {
    return head_of("GET /ws",
                   "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                   "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n\r\n");
  }
  /// With a mask of zeros.
  static std::string frame(unsigned opcode, const std::string& data) {
    return std::string{static_cast<char>(0x80U | opcode), static_cast<char>(0x80U | data.size())} +
           std::string(4, '\0') + data;
  }
  static std::string list() { return R"({"jsonrpc":"2.0","id":1,"method":"axis.list"})"; }
};

TEST_F(HttpWebSocket, TakesNothingBeforeItHasBegun) {
  send(upgrade() + frame(1, list()));
  client->shutdown(Tcp::socket::shutdown_send);
  work_until_closed();
  EXPECT_THAT(said, AllOf(StartsWith("HTTP/1.1 400"), HasSubstr("data_before_upgrade")));
}

TEST_F(HttpWebSocket, IsForText) {
  EXPECT_THAT(ask(upgrade()), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(ask(frame(1, list())), HasSubstr("\"result\""));
  const auto answer = ask(frame(2, list()));
  EXPECT_THAT(answer, testing::Not(HasSubstr("\"result\"")));
  EXPECT_THAT(answer, HasSubstr("\x03\xEB"));  // 1003
}

TEST_F(HttpWebSocket, EndsWithTheRightsOfItsClient) {
  EXPECT_THAT(ask(upgrade()), StartsWith("HTTP/1.1 101"));
  ask(frame(1, list()));
  said.clear();
  const auto config = parse_config("[daemon]\nsocket = \"/none\"\n" + two_axes() +
                                   "[[access]]\nrole = \"operate\"\nusers = [\"root\"]\n");
  bench.gateway().adopt(*config);
  for (const auto& one : connections->all()) one->end_if_it_lost_rights();
  const auto answer = ask(frame(1, list()));
  EXPECT_THAT(answer, AllOf(HasSubstr("less than before"), testing::Not(HasSubstr("result"))));
}

// ---- many ----

TEST_F(HttpClient, IsNotPushedOutByTheConnectionsOfAnotherNetwork) {
  std::vector<Tcp::socket> strangers;
  for (int i = 0; i < 40; ++i) {
    Tcp::acceptor acceptor(executor(), {boost::asio::ip::address_v4::loopback(), 0});
    strangers.emplace_back(executor()).connect(acceptor.local_endpoint());
    HttpConnectionInfo info{"192.0.2.1:5", "192.0.2.1", false, false, port};
    begin_http_connection(acceptor.accept(), nullptr, std::move(info), connections);
    work();
  }
  EXPECT_FALSE(is_closed);
  EXPECT_THAT(ask(head_of("GET /healthz", "\r\n")), StartsWith("HTTP/1.1 200"));
}

}  // namespace
}  // namespace tmcld::test
