// What a gateway says on a broker unasked: births, states, telemetry; and what waits to be said.
#include <gmock/gmock.h>

#include <boost/json/parse.hpp>

#include "protocol/axis_news.hpp"
#include "protocol/births.hpp"
#include "protocol/outbox.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

json::object state_at(int position, bool moving = false) {
  return {{"axis", "x"},
          {"position_microsteps", position},
          {"velocity_pps", moving ? 100 : 0},
          {"target_microsteps", 5000},
          {"position_reached", position == 5000},
          {"moving", moving},
          {"faults", json::array()},
          {"age_ms", position % 7},
          {"seq", position},
          {"event_time_ms", position},
          {"subscription", 1},
          {"dropped", 0},
          {"samples", json::array()}};
}

std::vector<std::string> topics_of(const std::vector<Publication>& news) {
  std::vector<std::string> topics;
  for (const auto& one : news) topics.push_back(one.topic);
  return topics;
}

class MqttAxisNews : public testing::Test {
 protected:
  std::vector<std::string> hear(const json::object& state) {
    return topics_of(news.hear(state, now));
  }
  const std::string of_state = "tmcl/v1/hall/state/x";
  const std::string of_telemetry = "tmcl/v1/hall/telemetry/x";
  AxisNews news{Topics("hall")};
  tmcl::TimePoint now{1h};
};

TEST_F(MqttAxisNews, RetainsAStateForAnHour) {
  const auto told = news.hear(state_at(7), now);
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(told[0].topic, of_state);
  EXPECT_TRUE(told[0].retained);
  EXPECT_EQ(told[0].expiry_s, 3600U);
  const auto state = json::parse(told[0].payload).as_object();
  EXPECT_EQ(state.at("position_microsteps"), 7);
  for (const auto* name : {"seq", "event_time_ms", "subscription", "age_ms"})
    EXPECT_FALSE(state.contains(name)) << name;
}

TEST_F(MqttAxisNews, TellsAStateWhenSomethingElseHasChangedThanThePlaceOnTheWay) {
  hear(state_at(0));
  EXPECT_THAT(hear(state_at(10, true)), ElementsAre(of_state)) << "it moves";
  EXPECT_THAT(hear(state_at(20, true)), IsEmpty());
  auto faulty = state_at(30, true);
  faulty["faults"] = json::array{"stall"};
  EXPECT_THAT(hear(faulty), ElementsAre(of_state));
  EXPECT_THAT(hear(state_at(5000)), ElementsAre(of_state)) << "it stands, and where";
  EXPECT_THAT(hear(state_at(5000)), IsEmpty());
  EXPECT_THAT(hear(state_at(5001)), ElementsAre(of_state)) << "it was told where it is";
}

TEST_F(MqttAxisNews, LeavesOutWhatIsNotToldAnyMore) {
  auto state = state_at(0);
  state["unit"] = "mm";
  EXPECT_THAT(hear(state), ElementsAre(of_state));
  const auto told = news.hear(state_at(0), now);
  ASSERT_THAT(told, SizeIs(1));
  const auto text = json::parse(told[0].payload).as_object();
  EXPECT_FALSE(text.contains("unit"));
  EXPECT_TRUE(text.contains("axis") && text.contains("target_microsteps"));
}

TEST_F(MqttAxisNews, TellsTelemetryTwiceASecondWhileItIsWanted) {
  hear(state_at(0, true));
  EXPECT_THAT(hear(state_at(1, true)), IsEmpty());
  news.wish("anna", 10s, now);
  EXPECT_THAT(topics_of(news.due(now)), ElementsAre(of_telemetry));
  std::size_t told = 0;
  for (int i = 2; i < 102; ++i) {
    now += 50ms;
    for (const auto& one : news.hear(state_at(i, true), now)) {
      EXPECT_EQ(one.topic, of_telemetry);
      EXPECT_FALSE(one.retained);
      EXPECT_EQ(one.qos, 0);
      ++told;
    }
  }
  EXPECT_EQ(told, 10U) << "in 5 s";
  now += 5s;
  EXPECT_FALSE(news.is_wanted(now));
  EXPECT_THAT(hear(state_at(200, true)), IsEmpty());
  EXPECT_THAT(news.due(now), IsEmpty());
}

TEST_F(MqttAxisNews, TellsTheLastTelemetryWhenItIsDue) {
  news.wish("anna", 10s, now);
  EXPECT_THAT(hear(state_at(1, true)), ElementsAre(of_state, of_telemetry));
  now += 100ms;
  EXPECT_THAT(hear(state_at(2, true)), IsEmpty());
  EXPECT_THAT(news.due(now), IsEmpty());
  now += 400ms;
  const auto due = news.due(now);
  EXPECT_THAT(topics_of(due), ElementsAre(of_telemetry));
  EXPECT_EQ(json::parse(due.at(0).payload).at("position_microsteps"), 2);
  EXPECT_THAT(news.due(now), IsEmpty());
}

TEST_F(MqttAxisNews, EndsWithTheWishOfEachUser) {
  news.wish("anna", 10s, now);
  news.wish("ben", 20s, now);
  news.wish("ben", 0s, now);
  EXPECT_TRUE(news.is_wanted(now));
  news.wish("anna", 0s, now);
  EXPECT_FALSE(news.is_wanted(now));
  for (std::size_t i = 0; i < 2 * AxisNews::most_wishes; ++i)
    news.wish("user" + std::to_string(i), 10s, now);
  EXPECT_TRUE(news.is_wanted(now));
}

TEST_F(MqttAxisNews, TellsStatesAgainBeforeTheBrokerDropsThem) {
  hear(state_at(0));
  EXPECT_THAT(news.due(now), IsEmpty());
  now += 31min;
  EXPECT_THAT(topics_of(news.due(now)), ElementsAre(of_state));
  EXPECT_THAT(news.due(now), IsEmpty());
  EXPECT_THAT(topics_of(news.all_states(now)), ElementsAre(of_state));
  news.forget_axes();
  EXPECT_THAT(news.all_states(now), IsEmpty());
}

TEST_F(MqttAxisNews, TakesStatesOffTheBrokerOfAxesThatHaveGone) {
  hear(state_at(0));
  auto other = state_at(0);
  other["axis"] = "y";
  hear(other);
  const auto cleared = news.keep_only({"x", "z"});
  ASSERT_THAT(cleared, SizeIs(1));
  EXPECT_EQ(cleared[0], (Publication{.topic = "tmcl/v1/hall/state/y", .retained = true}));
  EXPECT_THAT(news.keep_only({"x", "z"}), IsEmpty());
  EXPECT_EQ(news.all_states(now).size(), 1U);
}

TEST_F(MqttAxisNews, IsNotLedAstrayByOtherTexts) {
  EXPECT_THAT(hear({}), IsEmpty());
  EXPECT_THAT(hear({{"axis", 7}}), IsEmpty());
}

// ---- births ------------------------------------------------------------------------------------

class MqttBirths : public testing::Test {
 protected:
  Births births{"tmcl/v1/hall/birth", "0.2"};
  tmcl::TimePoint now{1h};
};

TEST_F(MqttBirths, AreRetainedAndSayWhatThereIs) {
  const auto birth = births.birth({"e1", 2s, "0.2.0", {"x", "y"}}, now);
  EXPECT_TRUE(birth.retained);
  EXPECT_EQ(birth.qos, 1);
  EXPECT_EQ(json::parse(birth.payload),
            json::parse(R"({"online":true,"epoch":"e1","nonce_ttl_ms":2000,"tmcld_mqtt":"0.2",
                            "tmcld":"0.2.0","axes":["x","y"]})"));
  EXPECT_TRUE(json::parse(births.birth({"e1", 2s, "", {}}, now).payload).at("tmcld").is_null());
  const auto will = births.will("e1");
  EXPECT_EQ(will.topic, birth.topic);
  EXPECT_TRUE(will.retained);
  EXPECT_EQ(json::parse(will.payload), json::parse(R"({"online":false,"epoch":"e1"})"));
}

TEST_F(MqttBirths, ReplaceAForeignOneOnceASecond) {
  EXPECT_EQ(births.due(now), std::nullopt);
  const auto birth = births.birth({"e2", 2s, "0.2.0", {}}, now);
  births.see({.topic = birth.topic, .payload = birth.payload});
  now += 1s;
  EXPECT_EQ(births.due(now), std::nullopt) << "its own";
  births.see({.topic = birth.topic, .payload = births.will("e1").payload});
  EXPECT_EQ(births.due(now), birth) << "a late will of the connection before";
  EXPECT_EQ(births.due(now), std::nullopt);
  births.see({.topic = birth.topic, .payload = "forged"});
  EXPECT_EQ(births.due(now + 999ms), std::nullopt);
  EXPECT_EQ(births.due(now + 1s), birth);
}

// ---- what waits --------------------------------------------------------------------------------

TEST(MqttOutbox, GivesAnswersFirstAndNewsOnceEachInOrder) {
  Outbox outbox;
  outbox.add_news({.topic = "a", .payload = "1"});
  outbox.add_news({.topic = "b", .payload = "1"});
  outbox.add_news({.topic = "a", .payload = "2"});
  outbox.add_answer({.topic = "r"});
  EXPECT_EQ(outbox.take()->topic, "r");
  EXPECT_EQ(outbox.take()->payload, "2");
  EXPECT_EQ(outbox.take()->topic, "b");
  EXPECT_EQ(outbox.take(), std::nullopt);
  EXPECT_TRUE(outbox.empty());
}

TEST(MqttOutbox, IsBounded) {
  Outbox outbox;
  for (std::size_t i = 0; i < 2 * Outbox::most_answers; ++i)
    outbox.add_answer({.topic = std::to_string(i)});
  EXPECT_EQ(outbox.take()->topic, std::to_string(Outbox::most_answers)) << "the oldest made room";
  for (int i = 0; i < 10; ++i)
    outbox.add_answer(
        {.topic = "long", .payload = std::string(Outbox::most_answer_bytes / 2, 'x')});
  std::size_t bytes = 0;
  while (const auto answer = outbox.take()) bytes += answer->payload.size();
  EXPECT_LE(bytes, Outbox::most_answer_bytes);
  EXPECT_GT(bytes, 0U);
}

}  // namespace
}  // namespace tmclmqtt
