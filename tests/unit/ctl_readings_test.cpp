// What a wait for an axis asks of a gateway, whatever that says to it.
#include <gmock/gmock.h>

#include <deque>
#include <string>
#include <vector>

#include "axis/readings.hpp"
#include "tmcl/api/system.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

namespace api = tmcl::api;
using namespace std::chrono_literals;
using testing::ElementsAre;

api::NewState state_at(std::int32_t position) {
  api::NewState state;
  state.axis = "x";
  state.position_microsteps = position;
  return state;
}

Error ended_early(const char* name, const char* message) {
  return {name, ErrorKind::ended_early, tmcl::Outcome::unknown, message, {}};
}

/// A gateway with an axis that arrives after some time; a wait takes as long as it says.
class ScriptedChannel final : public tmcl::client::Channel {
 public:
  explicit ScriptedChannel(FakeHost& host) : host_(host) {}

  Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                   const tmcl::client::CallOptions&) override {
    calls.emplace_back(method);
    if (method == "axis.wait") return wait(params);
    if (method == "axis.get_state") return api::to_json<api::axis::State>(state_at(100));
    if (method == "unsubscribe") return boost::json::object{};
    api::Subscription subscription;
    subscription.subscription = 7;
    subscription.states = {state_at(10)};
    return api::to_json(subscription);
  }
  Result<void> listen(tmcl::Duration) override { return {}; }
  Result<void> reopen() override { return {}; }
  void on_notification(Listener listener) override { listener_ = std::move(listener); }
  std::string version() const override { return {}; }

  tmcl::Duration arrives_after{};
  std::optional<Error> failure;  ///< What waits end with.
  std::vector<std::string> calls;
  std::vector<std::int64_t> waits_ms;

 private:
  Result<boost::json::object> wait(const boost::json::object& params) {
    EXPECT_EQ(params.at("target_microsteps"), 100);
    waits_ms.push_back(params.at("timeout_ms").as_int64());
    listener_("notify_state", api::to_json(state_at(50)));
    if (failure) return tl::unexpected(*failure);
    const std::chrono::milliseconds at_most(waits_ms.back());
    host_.sleep(std::min<tmcl::Duration>(at_most, arrives_after));
    arrives_after -= std::min<tmcl::Duration>(at_most, arrives_after);
    if (arrives_after > 0s) return tl::unexpected(ended_early("deadline_passed", "it moves"));
    return api::to_json(api::axis::Standing{{100, {}, {}}, {"it may oscillate"}});
  }

  FakeHost& host_;
  Listener listener_;
};

class WaitingForAnAxis : public testing::Test {
 protected:
  Result<Warnings> wait(std::optional<tmcl::Duration> at_most = {}) {
    return wait_for(
        {"x", {100}, 20ms, at_most},
        [this](const AxisReading& reading) { positions.push_back(reading.position_microsteps); },
        context);
  }

  FakeHost host;
  ScriptedChannel* channel = new ScriptedChannel(host);
  Gateway gateway{tmcl::client::Caller(std::unique_ptr<ScriptedChannel>(channel))};
  std::ostringstream text;
  Output output{text, text, {}, {}};
  Context context{gateway, output, host};
  std::vector<std::int32_t> positions;
};

TEST_F(WaitingForAnAxis, TakesAsLongAsItTakes) {
  channel->arrives_after = 12s;
  EXPECT_THAT(wait().value(), ElementsAre("it may oscillate"));
  EXPECT_THAT(channel->waits_ms, ElementsAre(5000, 5000, 5000));
  EXPECT_THAT(positions, ElementsAre(10, 50, 50, 50, 100)) << "the last one is of the end";
  EXPECT_EQ(channel->calls.back(), "unsubscribe");
}

TEST_F(WaitingForAnAxis, EndsWhenItsTimeIsOver) {
  channel->arrives_after = 1h;
  EXPECT_EQ(wait(12s).error().name, "deadline_passed");
  EXPECT_THAT(channel->waits_ms, ElementsAre(5000, 5000, 2000));
}

TEST_F(WaitingForAnAxis, AsksNothingMoreOfAGatewayThatSaysNothing) {
  channel->failure =
      Error{"daemon_timeout", ErrorKind::failed, tmcl::Outcome::unknown, "no answer", {}};
  EXPECT_EQ(wait().error().name, "daemon_timeout");
  EXPECT_EQ(channel->calls.back(), "axis.wait");
}

TEST_F(WaitingForAnAxis, LooksOnceMoreWhereAMoveWasInterrupted) {
  channel->failure = ended_early("move_interrupted", "it stands");
  EXPECT_EQ(wait().error().name, "move_interrupted");
  EXPECT_EQ(positions.back(), 100);
}

}  // namespace
}  // namespace tmclctl::test
