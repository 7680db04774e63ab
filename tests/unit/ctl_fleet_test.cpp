// tmclctl --fleet without a broker: what is published when, and what comes of what comes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include <sys/stat.h>

#include <boost/json.hpp>

#include "fleet/call_round.hpp"
#include "fleet/fleet_picture.hpp"
#include "fleet/fleet_place.hpp"
#include "fleet/fleet_verbs.hpp"
#include "fleet/stop_round.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "support/temp_path.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

namespace json = boost::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tmclmqtt::Message;
using tmclmqtt::Publication;

constexpr auto ms = [](int number) { return tmcl::Duration(std::chrono::milliseconds(number)); };
const tmcl::TimePoint begin{std::chrono::hours(1)};

Message message(std::string topic, std::string payload, std::string correlation = {}) {
  Message said;
  said.topic = std::move(topic);
  said.payload = std::move(payload);
  said.correlation = std::move(correlation);
  return said;
}
Message birth(const std::string& gateway, const std::string& axes, bool online = true) {
  return message("tmcl/v1/" + gateway + "/birth", std::string(R"({"online":)") +
                                                      (online ? "true" : "false") +
                                                      R"(,"tmcld":"1.0","axes":[)" + axes + "]}");
}
std::vector<std::string> topics_of(const std::vector<Publication>& publications) {
  std::vector<std::string> topics;
  for (const auto& one : publications) topics.push_back(one.topic);
  return topics;
}

// ---- where the broker is ----

TEST(CtlFleetPlace, ReadsUrls) {
  const auto broker = find_broker({.url = "mqtts://anna@broker.example"});
  ASSERT_TRUE(broker);
  EXPECT_TRUE(broker->tls);
  EXPECT_EQ(broker->host, "broker.example");
  EXPECT_EQ(broker->port, 8883);
  EXPECT_EQ(broker->user, "anna");
  EXPECT_EQ(find_broker({.url = "mqtt://a@[::1]:1999/"})->host, "::1");
  EXPECT_EQ(find_broker({.url = "mqtt://a@[::1]:1999/"})->port, 1999);
  EXPECT_EQ(find_broker({.url = "mqtt://a@h"})->port, 1883);
}

TEST(CtlFleetPlace, NamesWhatIsWrong) {
  for (const auto* url : {"broker", "http://a@b", "mqtts://", "mqtts://a@:1", "mqtts://a@b:0",
                          "mqtts://a@b:99999", "mqtts://a@b/c", "mqtt://a@b:x"}) {
    const auto broker = find_broker({.url = url});
    ASSERT_FALSE(broker) << url;
    EXPECT_EQ(broker.error().name, "bad_url") << url;
  }
  EXPECT_EQ(find_broker({.url = "mqtts://b"}).error().name, "no_user");
  EXPECT_EQ(find_broker({.url = "mqtts://a+b@c"}).error().name, "bad_user");
  EXPECT_EQ(find_broker({.url = "mqtt://a@c", .ca_file = "x"}).error().name, "bad_url");
  EXPECT_EQ(find_broker({.url = "mqtts://c", .certificate_file = "/none"}).error().name,
            "bad_certificate");
  EXPECT_EQ(find_broker({.url = "mqtts://c", .certificate_file = "/dev/null"}).error().name,
            "bad_certificate");
  EXPECT_EQ(find_broker({.url = "mqtts://a@c", .password_file = "/none"}).error().name,
            "cannot_read");
  const auto password = tmcl::test::temp_path("password");
  std::ofstream(password) << "secret\n";
  EXPECT_EQ(::chmod(password.c_str(), 0640), 0);
  EXPECT_EQ(find_broker({.url = "mqtts://a@c", .password_file = password})->password, "secret");
  EXPECT_EQ(::chmod(password.c_str(), 0644), 0);
  const auto readable = find_broker({.url = "mqtts://a@c", .password_file = password});
  ASSERT_FALSE(readable);
  EXPECT_THAT(readable.error().message, HasSubstr("chmod o-rwx " + password));
  std::filesystem::remove(password);
}

// ---- gateways ----

TEST(CtlGateways, AreKnownByTheirBirths) {
  Gateways gateways({"hall-*", "lab"});
  EXPECT_TRUE(gateways.hear(birth("hall-1", R"("x","y")")));
  EXPECT_TRUE(gateways.hear(birth("lab", "", false)));
  EXPECT_FALSE(gateways.hear(birth("shed", R"("x")")));
  EXPECT_THAT(gateways.all(), SizeIs(2));
  EXPECT_THAT(gateways.all().at("hall-1").axes, ElementsAre("x", "y"));
  EXPECT_TRUE(gateways.is_online("hall-1"));
  EXPECT_FALSE(gateways.is_online("lab"));
  EXPECT_THAT(gateways.unknown(), IsEmpty());
  EXPECT_TRUE(gateways.hear(message("tmcl/v1/lab/birth", "")));
  EXPECT_THAT(gateways.unknown(), ElementsAre("lab"));
}

TEST(CtlGateways, TakeAnyTextForABirth) {
  Gateways gateways({});
  for (const auto* payload :
       {"x", "[]", "null", R"({"online":1})", R"({"online":true,"axes":{}})",
        R"({"online":true,"axes":[1,"a\u001b[2J",null,"b"],"tmcld":"\u0007"})"})
    EXPECT_TRUE(gateways.hear(message("tmcl/v1/g/birth", payload)));
  EXPECT_THAT(gateways.all().at("g").axes, ElementsAre("b"));
  EXPECT_EQ(gateways.all().at("g").daemon, "?");
  for (const auto* topic :
       {"tmcl/v1/+/birth", "tmcl/v1/a b/birth", "tmcl/v1//birth", "x/v1/a/birth",
        "tmcl/v1/a/birth/b", "tmcl/v1/a", "tmcl/v1/all/birth", ""})
    EXPECT_FALSE(gateways.hear(message(topic, R"({"online":true})"))) << topic;
  const std::string deep(100'000, '[');
  EXPECT_TRUE(gateways.hear(message("tmcl/v1/h/birth", deep)));
  EXPECT_FALSE(gateways.is_online("h"));
}

// ---- calls ----

struct CtlCallRound : testing::Test {
  CallRound& round_of(std::vector<FleetCall> calls) {
    round.emplace(CallRound::Caller{"anna", "id7", "operate"}, std::move(calls),
                  [this](const FleetCall& call, const Result<json::object>& result) {
                    ends.push_back(call.gateway + ' ' +
                                   (result ? json::serialize(*result)
                                           : result.error().name + ' ' +
                                                 std::string(name_of(result.error().outcome))));
                  });
    return *round;
  }
  std::vector<Publication> due() { return round->due(now); }
  void answer(const Publication& to, std::string payload) {
    round->hear(message(to.response_topic, std::move(payload), to.correlation), now);
  }

  tmcl::TimePoint now = begin;
  std::optional<CallRound> round;
  std::vector<std::string> ends;
};

TEST_F(CtlCallRound, ReadsWithOneMessageEach) {
  round_of({{"g1", "axis.list"}, {"g2", "axis.list"}});
  const auto calls = due();
  EXPECT_THAT(topics_of(calls), ElementsAre("tmcl/v1/g1/call/operate/anna/axis.list",
                                            "tmcl/v1/g2/call/operate/anna/axis.list"));
  EXPECT_EQ(calls[0].response_topic, "tmcl/v1/reply/anna/g1/id7");
  EXPECT_EQ(calls[0].qos, 0);
  EXPECT_FALSE(calls[0].retained);
  EXPECT_THAT(due(), IsEmpty());
  answer(calls[1], R"({"result":{"a":1}})");
  answer(calls[0], R"({"result":{}})");
  EXPECT_TRUE(round->is_done());
  EXPECT_THAT(ends, ElementsAre(R"(g2 {"a":1})", "g1 {}"));
}

TEST_F(CtlCallRound, ActsWithTheNonceOfTheGateway) {
  round_of({{"g", "axis.move_to", {{"axis", "x"}}, true}});
  const auto asking = due();
  EXPECT_THAT(topics_of(asking), ElementsAre("tmcl/v1/g/call/operate/anna/nonce"));
  answer(asking[0], R"({"result":{},"epoch":"e","nonce":"n"})");
  const auto calls = due();
  ASSERT_THAT(calls, SizeIs(1));
  EXPECT_THAT(calls[0].topic, HasSubstr("axis.move_to"));
  EXPECT_EQ(json::parse(calls[0].payload),
            (json::value{{"epoch", "e"}, {"nonce", "n"}, {"params", {{"axis", "x"}}}}));
  // A nonce that has become old: the answer brings another one.
  answer(calls[0], R"({"error":{"data":{"name":"stale_nonce"}},"epoch":"e","nonce":"m"})");
  const auto again = due();
  ASSERT_THAT(again, SizeIs(1));
  EXPECT_THAT(again[0].payload, HasSubstr(R"("nonce":"m")"));
  answer(again[0], R"({"result":{"moves":true}})");
  EXPECT_THAT(ends, ElementsAre(R"(g {"moves":true})"));
}

TEST_F(CtlCallRound, DoesNotRepeatForEverWhatIsRefused) {
  round_of({{"g", "axis.move_to", {}, true}});
  for (int i = 0; i < 20 && !round->is_done(); ++i, now += ms(300)) {
    for (const auto& call : due())
      answer(
          call,
          call.topic.ends_with("nonce")
              ? R"({"result":{},"epoch":"e","nonce":"n"})"
              : R"({"error":{"data":{"name":"stale_epoch","outcome":"not_sent"}},"epoch":"f","nonce":"m"})");
  }
  EXPECT_THAT(ends, ElementsAre("g stale_epoch not_sent"));
}

TEST_F(CtlCallRound, NeverRepeatsWhatMayHaveBeenDone) {
  round_of({{"g", "axis.move_by", {}, true}});
  answer(due().at(0), R"({"result":{},"epoch":"e","nonce":"n"})");
  EXPECT_THAT(due(), SizeIs(1));
  now += CallRound::usual_patience;
  EXPECT_THAT(due(), IsEmpty());
  EXPECT_THAT(ends, ElementsAre("g gateway_timeout unknown"));
}

TEST_F(CtlCallRound, SaysThatNothingWasSentWhereNotEvenANonceCame) {
  round_of({{"g", "axis.move_by", {}, true}, {"h", "axis.list"}});
  due();
  now += CallRound::usual_patience;
  due();
  EXPECT_THAT(ends, ElementsAre("g gateway_timeout not_sent", "h gateway_timeout not_sent"));
}

TEST_F(CtlCallRound, EndsWithAGatewayThatIsDeclaredAway) {
  round_of({{"g", "axis.move_by", {}, true}, {"h", "axis.list"}, {"g", "axis.list"}});
  const auto asked = due();
  answer(asked[0], R"({"result":{},"epoch":"e","nonce":"n"})");
  due();
  round->give_up("g");
  EXPECT_THAT(ends, ElementsAre("g gateway_away unknown", "g gateway_away not_sent"));
  EXPECT_FALSE(round->is_done());
}

TEST_F(CtlCallRound, HearsNoForeignAnswers) {
  round_of({{"g", "axis.list"}, {"h", "axis.list"}});
  const auto calls = due();
  const auto hears = [&](std::string topic, std::string correlation) {
    return round->hear(message(std::move(topic), R"({"result":{}})", std::move(correlation)), now);
  };
  const auto right = calls[0].correlation;
  EXPECT_FALSE(hears("tmcl/v1/reply/anna/h/id7", right));  // of h for g's call
  EXPECT_FALSE(hears("tmcl/v1/reply/anna/g/id8", right));
  EXPECT_FALSE(hears("tmcl/v1/reply/eve/g/id7", right));
  for (const auto* correlation :
       {"", "0", "0.0", "0.2", "2.1", "-1", "0x", "99999999999999999999", "\xff"})
    EXPECT_FALSE(hears("tmcl/v1/reply/anna/g/id7", correlation)) << correlation;
  EXPECT_TRUE(hears("tmcl/v1/reply/anna/g/id7", right));
  EXPECT_FALSE(hears("tmcl/v1/reply/anna/g/id7", right));  // twice
  EXPECT_THAT(ends, SizeIs(1));
}

TEST_F(CtlCallRound, TakesNoSecondAnswerForTheAnswerToTheNextQuestion) {
  round_of({{"g", "axis.move_by", {}, true}});
  const auto asking = due().at(0);
  answer(asking, R"({"result":{},"epoch":"e","nonce":"n"})");
  const auto call = due().at(0);
  answer(asking, R"({"result":{},"epoch":"e","nonce":"n"})");
  EXPECT_FALSE(round->is_done());
  answer(call, R"({"result":{"moves":true}})");
  EXPECT_THAT(ends, ElementsAre(R"(g {"moves":true})"));
}

TEST_F(CtlCallRound, AsksAGatewayForAFewThingsAtATime) {
  std::vector<FleetCall> calls(100, FleetCall{"g", "axis.get_state"});
  calls.push_back({"h", "axis.get_state"});
  round_of(calls);
  auto open = due();
  EXPECT_THAT(open, SizeIs(CallRound::most_of_a_gateway + 1));
  std::size_t answered = 0;
  while (!open.empty()) {
    for (const auto& call : open) {
      answer(call, R"({"result":{}})");
      ++answered;
    }
    open = due();
  }
  EXPECT_EQ(answered, calls.size());
  EXPECT_TRUE(round->is_done());
}

std::string call_in(const std::string& correlation) {
  return correlation.substr(0, correlation.find('.'));
}

/// Whatever comes in whatever order: each call has one end, and nothing that acts is published
/// twice without a refusal between.
TEST(CtlCallRoundProperty, EndsEachCallOnce) {
  const auto seed = tmcl::test::seed();
  for (int round_number = 0; round_number < 300; ++round_number) {
    tmcl::test::Random<int> random(seed + static_cast<unsigned>(round_number));
    std::vector<FleetCall> calls;
    const int count = random.between(1, 30);
    for (int i = 0; i < count; ++i)
      calls.push_back(
          {"g" + std::to_string(random.between(0, 3)), "m", {}, random.between(0, 1) == 1});
    std::map<std::string, int> acted;
    int ends = 0;
    CallRound round({"u", "i", "operate"}, calls, [&](const auto&, const auto&) { ++ends; });
    std::vector<Publication> open;
    auto now = begin;
    for (int step = 0; step < 2000 && !round.is_done(); ++step) {
      for (auto& one : round.due(now)) {
        if (one.topic.ends_with("/m") && one.payload.find("nonce") != std::string::npos) {
          EXPECT_LE(++acted[call_in(one.correlation)], 1)
              << "seed " << seed << " round " << round_number;
        }
        open.push_back(std::move(one));
      }
      now += ms(random.between(0, 400));
      if (open.empty()) continue;
      const auto index =
          static_cast<std::size_t>(random.between(0, static_cast<int>(open.size()) - 1));
      const auto to = open[index];
      const std::vector<std::string> payloads{
          R"({"result":{},"epoch":"e","nonce":"n"})",
          R"({"result":{}})",
          "",
          "{}",
          "[1",
          R"({"error":{"data":{"name":"stale_nonce","outcome":"not_sent"}},"epoch":"e","nonce":"k"})",
          R"({"error":{"data":{"name":"too_many_requests","outcome":"not_sent"}}})",
          R"({"error":7})"};
      const auto& payload = payloads[static_cast<std::size_t>(random.between(0, 7))];
      if (payload.find("\"error\":{") != std::string::npos) acted[call_in(to.correlation)] = 0;
      round.hear(message(to.response_topic, payload, to.correlation), now);
      if (random.between(0, 2) > 0) open.erase(open.begin() + static_cast<std::ptrdiff_t>(index));
      if (random.between(0, 60) == 0) round.give_up("g0");
    }
    EXPECT_TRUE(round.is_done()) << "seed " << seed << " round " << round_number;
    EXPECT_EQ(ends, count) << "seed " << seed << " round " << round_number;
  }
}

// ---- stops ----

struct CtlStopRound : testing::Test {
  void acknowledge(const std::string& gateway, const std::string& stopped,
                   const std::string& failed = {}) {
    round->hear(
        message("tmcl/v1/reply/anna/" + gateway + "/id7",
                R"({"result":{"stopped":[)" + stopped + R"(],"failed":[)" + failed + "]}}"));
  }
  static std::string axis(const std::string& name) {
    return R"({"axis":")" + name + R"(","milliseconds":3})";
  }
  void begin_with(std::vector<std::string> patterns) {
    gateways.emplace(std::move(patterns));
    round.emplace(*gateways, "anna", "id7");
  }
  std::vector<std::string> due() {
    now += StopRound::interval;
    return topics_of(round->due(now));
  }

  tmcl::TimePoint now = begin;
  std::optional<Gateways> gateways;
  std::optional<StopRound> round;
};

TEST_F(CtlStopRound, BeginsBeforeItKnowsAnyGateway) {
  begin_with({});
  EXPECT_THAT(due(), ElementsAre("tmcl/v1/all/stop"));
  EXPECT_THAT(round->due(now + ms(50)), IsEmpty());
  EXPECT_THAT(due(), ElementsAre("tmcl/v1/all/stop"));
  EXPECT_FALSE(round->is_done());
  begin_with({"lab", "hall-*"});
  EXPECT_THAT(due(), ElementsAre("tmcl/v1/lab/stop"));
}

TEST_F(CtlStopRound, RepeatsItUntilEachAxisIsAcknowledged) {
  begin_with({});
  due();
  gateways->hear(birth("a", R"("x","y")"));
  gateways->hear(birth("b", R"("x")"));
  gateways->hear(birth("c", "", false));
  round->know_gateways();
  EXPECT_THAT(due(), ElementsAre("tmcl/v1/a/stop", "tmcl/v1/b/stop"));
  acknowledge("b", axis("x"));
  EXPECT_THAT(due(), ElementsAre("tmcl/v1/a/stop"));
  acknowledge("a", axis("x"), R"({"axis":"y","error":{"message":"no reply"}})");
  EXPECT_THAT(due(), ElementsAre("tmcl/v1/a/stop"));
  ASSERT_THAT(round->missing(), SizeIs(1));
  EXPECT_EQ(round->missing()[0].axis, "y");
  EXPECT_EQ(round->missing()[0].why, "no reply");
  EXPECT_FALSE(round->is_done());
  acknowledge("a", axis("y"));
  EXPECT_TRUE(round->is_done());
  EXPECT_THAT(due(), IsEmpty());
  EXPECT_THAT(round->away(), ElementsAre("c"));
}

TEST_F(CtlStopRound, EndsWithGatewaysThatAreDeclaredAway) {
  begin_with({});
  gateways->hear(birth("a", R"("x")"));
  round->know_gateways();
  EXPECT_FALSE(round->is_done());
  gateways->hear(birth("a", "", false));
  EXPECT_TRUE(round->is_done());
}

TEST_F(CtlStopRound, IsNotContentWithAGatewayWhoseTmcldIsAway) {
  begin_with({});
  gateways->hear(birth("a", ""));
  round->know_gateways();
  round->hear(message("tmcl/v1/reply/anna/a/id7", R"({"error":{"message":"tmcld is not there"}})"));
  ASSERT_THAT(round->missing(), SizeIs(1));
  EXPECT_EQ(round->missing()[0].why, "tmcld is not there");
  EXPECT_FALSE(round->is_done());
}

TEST_F(CtlStopRound, NamesGatewaysThatNobodyKnows) {
  begin_with({"lab"});
  due();
  round->know_gateways();
  EXPECT_THAT(round->unknown(), ElementsAre("lab"));
  EXPECT_TRUE(round->is_done());
}

TEST_F(CtlStopRound, HearsNoForeignAcknowledgement) {
  begin_with({"a"});
  gateways->hear(birth("a", R"("x")"));
  round->know_gateways();
  const auto said = R"({"result":{"stopped":[)" + axis("x") + "]}}";
  for (const auto* topic :
       {"tmcl/v1/reply/eve/a/id7", "tmcl/v1/reply/anna/b/id7", "tmcl/v1/reply/anna/a/id8",
        "tmcl/v1/reply/anna/a/id7/x", "tmcl/v1/reply/anna//id7", "tmcl/v1/a/state/x"})
    round->hear(message(topic, said));
  for (const auto* payload : {"", "7", R"({"result":{"stopped":[7,{"axis":7},{}]}})",
                              R"({"result":{"stopped":{"axis":"x"}}})"})
    round->hear(message("tmcl/v1/reply/anna/a/id7", payload));
  EXPECT_FALSE(round->is_done());
}

// ---- the verb ----

/// A broker with the gateway lab, whose module is off; time passes only while it is listened to.
class LinkToLab final : public FleetLink {
 public:
  explicit LinkToLab(FakeHost& host) : host_(host) {}

  const std::string& user() const override { return user_; }
  const std::string& id() const override { return id_; }
  void subscribe(const std::string& filter) override {
    if (filter == Gateways::filter) coming_.push_back(birth("lab", R"("x","y")"));
  }
  void publish(const Publication& publication) override {
    if (publication.topic.ends_with("/stop")) {
      ++stops;
      coming_.push_back(message(
          "tmcl/v1/reply/anna/lab/id7",
          R"({"result":{"stopped":[],"failed":[{"axis":"x","error":{"message":"no reply"}}]}})"));
    } else {
      coming_.push_back(message(publication.topic, publication.payload));
    }
  }
  Result<void> listen(tmcl::Duration at_most) override {
    host_.sleep(at_most);
    for (const auto& one : std::exchange(coming_, {})) on_message_(one);
    return {};
  }
  void on_message(OnMessage on_message) override { on_message_ = std::move(on_message); }

  int stops = 0;

 private:
  FakeHost& host_;
  std::string user_ = "anna";
  std::string id_ = "id7";
  OnMessage on_message_;
  std::vector<Message> coming_;
};

struct CtlFleetStop : testing::Test {
  Result<ExitCode> stop_all() {
    Output output{out, err, {}, {}};
    Fleet fleet(link, {}, output, host);
    return run_in_fleet(verb::Stop{.axis = {}, .all = true}, fleet);
  }
  double seconds() const {
    return std::chrono::duration<double>(host.now() - FakeHost().now()).count();
  }

  FakeHost host;
  LinkToLab link{host};
  std::ostringstream out;
  std::ostringstream err;
};

TEST_F(CtlFleetStop, NamesWhatIsNotAcknowledgedWithinTwentySeconds) {
  const auto exit = stop_all();
  ASSERT_TRUE(exit);
  EXPECT_EQ(*exit, ExitCode::unknown);
  EXPECT_NEAR(seconds(), 20, 0.1);
  EXPECT_NEAR(link.stops, 200, 20);
  EXPECT_THAT(err.str(), HasSubstr("lab x: NOT stopped: no reply"));
  EXPECT_THAT(err.str(), HasSubstr("lab y: NOT stopped: no answer"));
}

TEST_F(CtlFleetStop, NamesItAlsoWhenItIsInterrupted) {
  host.catch_signals();
  host.press_ctrl_c_after(ms(3000));
  const auto exit = stop_all();
  ASSERT_FALSE(exit);
  EXPECT_EQ(exit.error().kind, ErrorKind::interrupted);
  EXPECT_NEAR(seconds(), 3, 0.1);
  EXPECT_THAT(err.str(), HasSubstr("lab x: NOT stopped: no reply"));
}

// ---- the picture ----

TEST(CtlFleetPicture, ShowsWhatIsWrongFirst) {
  Gateways gateways({});
  FleetPicture picture(gateways);
  EXPECT_THAT(picture.filters(), ElementsAre("tmcl/v1/+/state/+", "tmcl/v1/+/telemetry/+"));
  for (const auto* name : {"a", "b", "c"}) gateways.hear(birth(name, R"("x")"));
  gateways.hear(birth("d", "", false));
  picture.hear(
      message("tmcl/v1/b/state/x", R"({"axis":"x","moving":true,"position_microsteps":5})"));
  picture.hear(message("tmcl/v1/b/telemetry/x", R"({"position_microsteps":77})"));
  picture.hear(message("tmcl/v1/c/state/x", R"({"axis":"x","faults":["undervoltage"]})"));
  picture.hear(message("tmcl/v1/c/state/x/y", "{}"));
  picture.hear(message("tmcl/v1/a/state/x", "[[["));
  const auto lines = picture.lines(100, true, true);
  const std::string text = [&] {
    std::string all;
    for (const auto& line : lines) all += line + '\n';
    return all;
  }();
  EXPECT_THAT(text, HasSubstr("4 gateways, 1 away; 1 axes moving, 1 with something wrong"));
  EXPECT_THAT(text, HasSubstr("77"));
  EXPECT_LT(text.find("\nd "), text.find("\nc "));
  EXPECT_LT(text.find("\nc "), text.find("\nb "));
  EXPECT_LT(text.find("\nb "), text.find("\na "));
}

TEST(CtlFleetPicture, SubscribesToNamesWhereThereAreOnlyThose) {
  Gateways gateways({"lab"});
  EXPECT_THAT(FleetPicture(gateways).filters(),
              ElementsAre("tmcl/v1/lab/state/+", "tmcl/v1/lab/telemetry/+"));
}

}  // namespace
}  // namespace tmclctl::test
