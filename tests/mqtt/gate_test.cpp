// What becomes of messages to a gateway: every way in which one is refused.
#include "protocol/gate.hpp"

#include <gmock/gmock.h>

#include <boost/json/serialize.hpp>

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using tmcl::Effect;

class MqttGate : public testing::Test {
 protected:
  MqttGate() {
    gate.know_methods({{"axis.move_to", Effect::moves},
                       {"axis.rotate", Effect::moves},
                       {"axis.get_state", Effect::reads},
                       {"axis.stop", Effect::stops},
                       {"lease.renew", Effect::writes},
                       {"subscribe", Effect::reads},
                       {"speak_for", Effect::reads}});
    gate.begin_epoch();
    pass(0ms);
  }

  /// As the reactor does, which looks ten times a second.
  void pass(tmcl::Duration time) {
    for (const auto end = now + time; now < end; look()) now += std::min(end - now, step);
    look();
  }
  Message call(const std::string& method, const json::object& said = {}) const {
    return {.topic = "tmcl/v1/hall/call/operate/anna/" + method,
            .payload = json::serialize(said),
            .response_topic = "tmcl/v1/reply/anna/hall/1",
            .correlation = "7"};
  }
  json::object fresh(const json::object& params = {{"axis", "x"}}) {
    return {{"params", params}, {"epoch", gate.epoch()}, {"nonce", gate.give_nonce("anna", now)}};
  }
  void look() { gate.look(now, slept); }
  Judged judge(const Message& message) {
    look();
    return gate.judge(message, now);
  }
  /// Name of the error, or what it is instead.
  std::string refusal(const Message& message) {
    const auto judged = judge(message);
    if (const auto* refused = std::get_if<Refused>(&judged.is)) {
      EXPECT_EQ(refused->error.outcome, tmcl::Outcome::not_sent);
      EXPECT_THAT(refused->error.message, testing::Not(IsEmpty()));
      return refused->error.name;
    }
    if (std::holds_alternative<CallWanted>(judged.is)) return "call";
    return std::holds_alternative<Nothing>(judged.is) ? "nothing" : "else";
  }

  static constexpr tmcl::Duration step = 100ms;
  int drawn = 0;
  Gate gate{"hall", [this] { return "drawn-" + std::to_string(++drawn); }, 2s};
  tmcl::TimePoint now{1h};
  tmcl::Duration slept{};
};

TEST_F(MqttGate, PassesACallWithEpochAndNonce) {
  const auto judged = judge(call("axis.move_to", fresh({{"axis", "x"}, {"position", 5}})));
  const auto& wanted = std::get<CallWanted>(judged.is);
  EXPECT_EQ(wanted.user, "anna");
  EXPECT_EQ(wanted.role, Role::operate);
  EXPECT_EQ(wanted.method, "axis.move_to");
  EXPECT_EQ(wanted.effect, Effect::moves);
  EXPECT_EQ(wanted.params, (json::object{{"axis", "x"}, {"position", 5}}));
  ASSERT_TRUE(judged.reply);
  EXPECT_EQ(judged.reply->topic, "tmcl/v1/reply/anna/hall/1");
  EXPECT_EQ(judged.reply->correlation, "7");
}

TEST_F(MqttGate, NeedsNeitherToReadOrToStop) {
  EXPECT_EQ(refusal(call("axis.get_state", {{"params", {{"axis", "x"}}}})), "call");
  EXPECT_EQ(refusal(call("axis.stop", {{"params", {{"axis", "x"}}}})), "call");
}

TEST_F(MqttGate, TakesANonceOnce) {
  const auto message = call("axis.move_to", fresh());
  EXPECT_EQ(refusal(message), "call");
  EXPECT_EQ(refusal(message), "stale_nonce") << "doubled on the way, or recorded and sent again";
}

TEST_F(MqttGate, TakesANonceForItsTime) {
  const auto early = call("axis.move_to", fresh());
  const auto late = call("axis.move_to", fresh());
  pass(2s);
  EXPECT_EQ(refusal(early), "call");
  pass(1ms);
  EXPECT_EQ(refusal(late), "stale_nonce");
}

TEST_F(MqttGate, TakesNoNonceOfAnotherUser) {
  const json::object said{{"epoch", gate.epoch()}, {"nonce", gate.give_nonce("ben", now)}};
  EXPECT_EQ(refusal(call("axis.move_to", said)), "stale_nonce");
}

TEST_F(MqttGate, TakesNoCallWithoutNonceOrEpoch) {
  auto said = fresh();
  said.erase("nonce");
  EXPECT_EQ(refusal(call("axis.move_to", said)), "stale_nonce");
  said = fresh();
  said.erase("epoch");
  EXPECT_EQ(refusal(call("axis.move_to", said)), "stale_epoch");
  said = fresh();
  said["nonce"] = 7;
  EXPECT_EQ(refusal(call("axis.move_to", said)), "stale_nonce");
  EXPECT_EQ(refusal(call("axis.move_to")), "stale_epoch");
}

TEST_F(MqttGate, RenewsALeaseOnlyLikeThat) {
  EXPECT_EQ(refusal(call("lease.renew", {{"params", {{"lease", 1}}}})), "stale_epoch");
  EXPECT_EQ(refusal(call("lease.renew", fresh({{"lease", 1}}))), "call");
}

TEST_F(MqttGate, TakesNothingFromBeforeAConnection) {
  const auto message = call("axis.move_to", fresh());
  gate.begin_epoch();
  EXPECT_EQ(refusal(message), "stale_epoch");
  auto said = fresh();
  const auto nonce = said.at("nonce");
  gate.begin_epoch();
  EXPECT_EQ(refusal(call("axis.move_to", {{"epoch", gate.epoch()}, {"nonce", nonce}})),
            "stale_nonce");
}

TEST_F(MqttGate, RefusesWhatWaitedWhileTheReactorStoodStill) {
  const auto message = call("axis.move_to", fresh());
  const auto judged_at = now;
  now += 1001ms;  // within the time of the nonce
  EXPECT_EQ(refusal(message), "stale_nonce");
  EXPECT_TRUE(gate.is_stale(judged_at)) << "a call that waits for its connection";
  EXPECT_EQ(gate.stale_call().name, "stale_request");
  EXPECT_FALSE(gate.is_stale(now));
  EXPECT_EQ(refusal(call("axis.move_to", fresh())), "call");
}

TEST_F(MqttGate, RefusesWhatWaitedWhileTheComputerSlept) {
  const auto message = call("axis.move_to", fresh());
  slept += 1h;
  EXPECT_EQ(refusal(message), "stale_nonce");
  EXPECT_EQ(refusal(call("axis.move_to", fresh())), "call");
}

TEST_F(MqttGate, KeepsNoncesWhileTheReactorTurns) {
  const auto message = call("axis.move_to", fresh());
  now += 1000ms;
  EXPECT_EQ(refusal(message), "call");
}

// ---- retained ----------------------------------------------------------------------------------

TEST_F(MqttGate, RefusesARetainedCallAndHasItCleared) {
  for (const auto* method : {"axis.move_to", "axis.get_state", "nonce"}) {
    auto message = call(method, fresh());
    message.retained = true;
    EXPECT_EQ(refusal(message), "retained_call") << method;
    EXPECT_TRUE(judge(message).must_be_cleared);
    EXPECT_TRUE(judge(message).reply);
    message.response_topic.clear();
    EXPECT_TRUE(judge(message).must_be_cleared) << "also where its client cannot be told";
  }
}

TEST_F(MqttGate, TakesTheClearingForNothing) {
  auto message = call("axis.move_to");
  message.payload.clear();
  message.retained = true;
  EXPECT_EQ(refusal(message), "nothing");
  EXPECT_FALSE(judge(message).must_be_cleared);
}

// ---- stops -------------------------------------------------------------------------------------

TEST_F(MqttGate, StopsByAMethodAlsoWhereTheMessageIsRetainedAndEmpty) {
  auto message = call("axis.stop");
  message.payload.clear();
  message.retained = true;
  EXPECT_EQ(refusal(message), "call");
  EXPECT_FALSE(judge(message).must_be_cleared);
}

TEST_F(MqttGate, StopsOnBothTopicsWhateverIsInTheMessage) {
  for (const auto* topic : {"tmcl/v1/hall/stop", "tmcl/v1/all/stop"}) {
    for (const auto* payload : {"", "{}", "{\"params\":7", "stop!"}) {
      const auto judged = judge({.topic = topic, .payload = payload});
      EXPECT_TRUE(std::holds_alternative<StopWanted>(judged.is)) << topic << payload;
      EXPECT_FALSE(judged.reply);
    }
  }
  const auto judged = judge({.topic = "tmcl/v1/hall/stop",
                             .response_topic = "tmcl/v1/reply/ben/hall/stop",
                             .correlation = "c"});
  ASSERT_TRUE(judged.reply);
  EXPECT_EQ(judged.reply->topic, "tmcl/v1/reply/ben/hall/stop");
  EXPECT_THAT(judged.reply->user, IsEmpty()) << "it is known of no user, and gives out no nonce";
  const auto of_all =
      judge({.topic = "tmcl/v1/all/stop", .response_topic = "tmcl/v1/reply/ben/all/stop"});
  EXPECT_EQ(of_all.reply.value().topic, "tmcl/v1/reply/ben/hall/stop") << "each its own";
}

TEST_F(MqttGate, StopsWithoutTmcldsMethodsAndAfterAGap) {
  gate.know_methods({});
  now += 5s;
  EXPECT_TRUE(std::holds_alternative<StopWanted>(judge({.topic = "tmcl/v1/hall/stop"}).is));
}

TEST_F(MqttGate, StopsByARetainedStopAndHasItsOwnCleared) {
  auto judged = judge({.topic = "tmcl/v1/hall/stop", .payload = "{}", .retained = true});
  EXPECT_TRUE(std::holds_alternative<StopWanted>(judged.is));
  EXPECT_TRUE(judged.must_be_cleared);
  judged = judge({.topic = "tmcl/v1/all/stop", .payload = "{}", .retained = true});
  EXPECT_TRUE(std::holds_alternative<StopWanted>(judged.is));
  EXPECT_FALSE(judged.must_be_cleared) << "other gateways have not seen it yet";
  auto message = call("axis.stop", {{"params", {{"axis", "x"}}}});
  message.retained = true;
  EXPECT_EQ(refusal(message), "call");
  EXPECT_TRUE(judge(message).must_be_cleared);
  EXPECT_TRUE(std::holds_alternative<StopWanted>(
      judge({.topic = "tmcl/v1/hall/stop", .retained = true}).is))
      << "the shortest stop there is, by a client that retains all";
}

// ---- bad input ---------------------------------------------------------------------------------

TEST_F(MqttGate, RefusesWhatIsNoCall) {
  auto message = call("axis.get_state");
  for (const auto* text : {"x", "[]", "7", "{\"params\":{}", "\xff\xfe"}) {
    message.payload = text;
    EXPECT_EQ(refusal(message), "parse_error") << text;
  }
  message.payload = std::string(200, '[');
  EXPECT_EQ(refusal(message), "parse_error");
  message.payload = std::string(max_payload_bytes + 1, ' ');
  EXPECT_EQ(refusal(message), "line_too_long");
  EXPECT_EQ(refusal(call("axis.get_state", {{"params", 7}})), "invalid_request");
  EXPECT_EQ(refusal(call("axis.get_state", {{"axis", "x"}})), "invalid_request");
  EXPECT_EQ(refusal(call("axis.got_state")), "method_not_found");
  EXPECT_EQ(refusal(call("subscribe")), "not_by_mqtt");
  EXPECT_EQ(refusal(call("speak_for")), "not_by_mqtt");
}

TEST_F(MqttGate, SaysThatTmcldIsNotThere) {
  gate.know_methods({});
  EXPECT_EQ(refusal(call("axis.move_to", fresh())), "daemon_unreachable");
}

TEST_F(MqttGate, ABadCallKeepsItsNonceForARightOne) {
  auto said = fresh();
  said["param"] = 1;
  EXPECT_EQ(refusal(call("axis.move_to", said)), "invalid_request");
  said.erase("param");
  EXPECT_EQ(refusal(call("axis.move_to", said)), "call");
}

TEST_F(MqttGate, AnswersOnlyToTopicsOfTheUser) {
  for (const auto* topic :
       {"", "tmcl/v1/reply/ben/hall/1", "tmcl/v1/hall/birth", "tmcl/v1/reply/anna/hall/+",
        "tmcl/v1/reply/anna/hall/#", "tmcl/v1/reply/anna/hall/", "tmcl/v1/reply/anna/hall",
        "tmcl/v1/all/stop", "tmcl/v1/reply/annabel/hall/1", "tmcl/v1/reply/anna/hall2/1",
        "tmcl/v1/reply/anna/all/1"}) {
    auto message = call("axis.move_to", fresh());
    message.response_topic = topic;
    EXPECT_EQ(refusal(message), "nothing") << topic;
    message.topic = "tmcl/v1/hall/call/operate/anna/axis.stop";
    const auto judged = judge(message);
    EXPECT_TRUE(std::holds_alternative<CallWanted>(judged.is)) << "a stop wins without an answer";
    EXPECT_FALSE(judged.reply) << topic;
  }
  auto message = call("axis.get_state");
  message.correlation = std::string(max_correlation_bytes + 1, 'c');
  EXPECT_EQ(refusal(message), "nothing");
}

TEST_F(MqttGate, TakesNothingOnOtherTopics) {
  for (const auto* topic :
       {"", "tmcl/v1/hall", "tmcl/v1/hall/", "tmcl/v1/hall2/stop", "tmcl/v1/hall/call/operate/anna",
        "tmcl/v1/hall/call/king/anna/axis.stop", "tmcl/v1/hall/call/operate/an na/axis.stop",
        "tmcl/v1/hall/call/operate//axis.stop", "tmcl/v1/hall/call/operate/anna/axis/stop",
        "tmcl/v1/hall/call/operate/+/axis.stop", "tmcl/v1/hall/call/operate/anna/#",
        "tmcl/v1/reply/anna/hall/1", "tmcl/v2/hall/stop", "tmcl/v1/hall/stop/now"}) {
    auto message = call("axis.stop");
    message.topic = topic;
    EXPECT_EQ(refusal(message), "nothing") << topic;
  }
}

TEST_F(MqttGate, LetsAnAxisTurnOnlyWhileSomethingEndsIt) {
  EXPECT_EQ(refusal(call("axis.rotate", fresh({{"axis", "x"}}))), "needs_lease");
  EXPECT_EQ(refusal(call("axis.rotate", fresh({{"axis", "x"}, {"unattended", false}}))),
            "needs_lease");
  EXPECT_EQ(refusal(call("axis.rotate", fresh({{"axis", "x"}, {"unattended", true}}))), "call");
  EXPECT_EQ(refusal(call("axis.rotate", fresh({{"axis", "x"}, {"lease", 1}, {"epoch", 5}}))),
            "call");
}

TEST_F(MqttGate, GivesNoncesByACallOfTheirOwn) {
  EXPECT_TRUE(std::holds_alternative<NonceWanted>(judge(call("nonce")).is));
}

TEST_F(MqttGate, DropsWhatAUserCallsTooOften) {
  std::map<std::string, int> became;
  for (int i = 0; i < 1000; ++i) ++became[refusal(call("axis.get_state"))];
  EXPECT_EQ(became, (std::map<std::string, int>{
                        {"call", 100}, {"too_many_requests", 1}, {"nothing", 899}}));
  EXPECT_EQ(refusal(call("axis.stop")), "call") << "a stop always wins";
  auto of_ben = call("axis.get_state");
  of_ben.topic = "tmcl/v1/hall/call/observe/ben/axis.get_state";
  of_ben.response_topic = "tmcl/v1/reply/ben/hall/1";
  EXPECT_EQ(refusal(of_ben), "call");
  pass(1s);
  became.clear();
  for (int i = 0; i < 1000; ++i) ++became[refusal(call("axis.get_state"))];
  EXPECT_EQ(became,
            (std::map<std::string, int>{{"call", 50}, {"too_many_requests", 1}, {"nothing", 949}}));
}

TEST(MqttCallRate, RemembersSomeUsers) {
  CallRate rate;
  tmcl::TimePoint now{1h};
  for (std::size_t i = 0; i < 10 * CallRate::most_users; ++i)
    EXPECT_EQ(rate.judge("user" + std::to_string(i), now += 1ms), CallRate::Verdict::pass);
}

// ---- wishes ------------------------------------------------------------------------------------

TEST_F(MqttGate, TakesWishesThatEnd) {
  Message message{.topic = "tmcl/v1/hall/want/anna", .payload = "{}", .retained = true};
  auto judged = judge(message);
  EXPECT_TRUE(std::holds_alternative<Nothing>(judged.is));
  EXPECT_TRUE(judged.must_be_cleared) << "it would be there for ever";
  message.expiry_s = 30;
  judged = judge(message);
  EXPECT_FALSE(judged.must_be_cleared);
  EXPECT_EQ(std::get<WishMade>(judged.is).user, "anna");
  EXPECT_EQ(std::get<WishMade>(judged.is).time, 30s);
  message.expiry_s = 4'000'000'000U;
  EXPECT_EQ(std::get<WishMade>(judge(message).is).time, 1h);
  message.payload.clear();
  EXPECT_EQ(std::get<WishMade>(judge(message).is).time, 0s);
}

// ---- nonces ------------------------------------------------------------------------------------

TEST(MqttNonces, AreFewForEachUserAndInAll) {
  int drawn = 0;
  Nonces nonces([&] { return std::to_string(++drawn); }, 2s);
  const tmcl::TimePoint now{1h};
  const auto bens = nonces.give("ben", now);
  const auto first = nonces.give("anna", now);
  std::string last;
  for (std::size_t i = 0; i < Nonces::most_of_a_user; ++i) last = nonces.give("anna", now);
  EXPECT_FALSE(nonces.take("anna", first, now));
  EXPECT_TRUE(nonces.take("anna", last, now));
  EXPECT_TRUE(nonces.take("ben", bens, now)) << "another user's flood costs none of it";
  const auto oldest = nonces.give("ben", now);
  for (std::size_t i = 0; i < Nonces::most; ++i) nonces.give("user" + std::to_string(i), now);
  EXPECT_FALSE(nonces.take("ben", oldest, now));
}

// ---- names -------------------------------------------------------------------------------------

TEST(MqttTopics, AreOfGatewaysThatCanBeNamed) {
  for (const auto* name : {"hall-1", "a", "A.b_c@d"}) EXPECT_TRUE(is_gateway_name(name)) << name;
  for (const auto* name : {"", "+", "#", "a/b", "a b", "all", "reply", "$SYS", "\xC3\xA4"})
    EXPECT_FALSE(is_gateway_name(name)) << name;
  EXPECT_FALSE(is_gateway_name(std::string(max_level_bytes + 1, 'a')));
}

}  // namespace
}  // namespace tmclmqtt
