// A tmcld with simulated modules in one process: how its time goes on.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "config/load.hpp"
#include "log/log.hpp"
#include "sim/bench.hpp"
#include "support/rpc_client.hpp"
#include "support/temp_path.hpp"
#include "tmcl/context_clock.hpp"
#include "tmcl/model.hpp"
#include "tmcl/seconds.hpp"
#include "tools/tmclsim/own_gateway.hpp"

namespace tmclsim {
namespace {

namespace json = boost::json;
using testing::HasSubstr;
using tmcl::test::RpcClient;

constexpr auto serial_link = "serial:/dev/none@115200";

class OwnGatewayTest : public testing::Test {
 protected:
  explicit OwnGatewayTest(const std::string& link = serial_link, const std::string& more = {})
      : socket_(tmcl::test::temp_path("own_gateway.sock")) {
    tmcld::silence_log();
    bench_.add(*tmcl::find_model("TMCM-3110"), tmcl::ModuleAddress{1});
    const auto config = tmcld::parse_config(
        "[daemon]\nsocket = \"" + socket_ + "\"\n[[bus]]\nname = \"bench\"\nlink = \"" + link +
        "\"\n" + more + "[[axis]]\nname = \"x\"\nbus = \"bench\"\naddress = 1\nmotor = 0\n");
    auto own = OwnGateway::create(io_, time_, modules_, config.value(), {});
    if (own) own_ = std::move(*own);
  }
  ~OwnGatewayTest() override {
    if (!own_) return;
    own_->daemon().stop();
    while (!own_->daemon().has_ended()) own_->turn();
  }
  void SetUp() override { ASSERT_NE(own_, nullptr); }

  OwnGateway& own() { return *own_; }
  tmcl::test::DaemonSocket socket() {
    return {socket_, [this](int descriptor, short events, int) {
              const auto ready = [&] {
                return tmcl::test::wait_in_real_time(descriptor, events, 0);
              };
              return turn_until(ready);
            }};
  }
  /// False if time stands still before that.
  template <class Condition>
  bool turn_until(Condition condition) {
    while (true) {
      time_.settle();
      if (condition()) return true;
      if (!own_->goes_on()) return false;
      own_->turn();
    }
  }
  void run_for(const std::string& seconds) {
    EXPECT_EQ(own_->answer("run " + seconds), "");
    turn_until([] { return false; });
  }
  double elapsed() const { return tmcl::seconds(own_->elapsed()); }

 private:
  const std::string socket_;
  boost::asio::io_context io_{1};
  tmcl::VirtualTime time_{io_};
  tmcl::ContextClock clock_{io_};
  tmcl::sim::Bench bench_{clock_};
  tmcl::sim::Scheduler modules_{io_, bench_};
  std::unique_ptr<OwnGateway> own_;
};

json::object to(std::int64_t microsteps) {
  return {{"axis", "x"}, {"position_microsteps", microsteps}};
}
const json::object of_x{{"axis", "x"}};

TEST_F(OwnGatewayTest, TimeStandsStillWhileNoCallWaits) {
  RpcClient client(socket());
  const auto before = own().elapsed();
  EXPECT_EQ(client.greeting().at("params").at("time").as_string(), "virtual");
  EXPECT_EQ(own().elapsed(), before);
  EXPECT_FALSE(own().goes_on());
}

TEST_F(OwnGatewayTest, AMoveBeginsAtOnceAndItsEndIsWaitedForInItsOwnTime) {
  RpcClient client(socket());
  const auto began = elapsed();
  const auto started = client.call("axis.move_to", to(2'000'000)).at("result").as_object();
  EXPECT_LT(elapsed() - began, 0.1);
  EXPECT_LT(client.call("axis.get_state", of_x).at("result").at("position_microsteps").as_int64(),
            2'000);
  const auto stands = client.call("axis.wait", of_x).at("result").as_object();
  EXPECT_EQ(stands.at("position_microsteps").as_int64(), 2'000'000);
  const auto predicted = started.at("predicted_s").as_double();
  EXPECT_GT(predicted, 30);
  EXPECT_NEAR(elapsed() - began, predicted, 0.1);
}

TEST_F(OwnGatewayTest, TimePassesOnRequestAsFarAsIsAskedFor) {
  RpcClient client(socket());
  const auto started = client.call("axis.move_to", to(500'000)).at("result").as_object();
  const auto before = own().elapsed();
  run_for("2.5");
  EXPECT_EQ(own().elapsed() - before, std::chrono::milliseconds(2500));
  EXPECT_TRUE(client.call("axis.get_state", of_x).at("result").at("moving").as_bool());
  run_for(std::to_string(started.at("predicted_s").as_double()));
  const auto state = client.call("axis.get_state", of_x).at("result").as_object();
  EXPECT_TRUE(state.at("position_reached").as_bool());
}

TEST_F(OwnGatewayTest, TheConsoleTellsTheTimeAndRefusesWhatIsNone) {
  for (const auto* wrong : {"run", "run x", "run -1", "run nan", "run inf", "run 1000001"})
    EXPECT_THAT(own().answer(wrong), HasSubstr("error: ")) << wrong;
  EXPECT_EQ(own().answer("now"), "ok 0");
  run_for("0.25");
  EXPECT_EQ(own().answer("now"), "ok 0.25");
  EXPECT_EQ(own().answer("load 1/0 500"), "ok");
  EXPECT_EQ(own().answer("run 1"), "");
  EXPECT_THAT(own().answer("run 1"), HasSubstr("error: "));
  EXPECT_EQ(own().answer(""), "");
}

TEST_F(OwnGatewayTest, ALeaseRunsOutInTimeThatIsAskedForAndNotInThatOfACall) {
  RpcClient client(socket());
  client.call("axis.move_to", to(300'000));
  const json::object of_half_a_second{{"axes", json::array{"x"}}, {"ttl_ms", 500}};
  EXPECT_TRUE(client.call("lease.acquire", of_half_a_second).contains("result"));
  const auto leases = [&] {
    return client.call("lease.list", {}).at("result").at("leases").as_array().size();
  };
  EXPECT_TRUE(client.call("axis.wait", of_x).contains("result"));
  EXPECT_GT(elapsed(), 3);
  EXPECT_EQ(leases(), 1U);
  run_for("0.4");
  EXPECT_EQ(leases(), 1U);
  run_for("0.2");
  EXPECT_EQ(leases(), 0U);
}

TEST_F(OwnGatewayTest, WhatTurnsStopsWhenItsClientGoesWhileItWaits) {
  RpcClient watching(socket());
  {
    RpcClient client(socket());
    EXPECT_TRUE(
        client.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}}).contains("result"));
    client.send("axis.wait", of_x);
    EXPECT_TRUE(turn_until([&] { return elapsed() > 1; }));
  }
  turn_until([] { return false; });
  run_for("2");
  EXPECT_FALSE(watching.call("axis.get_state", of_x).at("result").at("moving").as_bool());
}

TEST_F(OwnGatewayTest, ADeadlineCountsInItsTimeWhateverTheClockOfTheClientSays) {
  RpcClient client(socket());
  run_for("100");
  auto params = to(1'000);
  params["sent_at_ms"] = 1;
  params["deadline_ms"] = 1'000;
  EXPECT_TRUE(client.call("axis.move_to", params).contains("result"));
  client.call("axis.move_to", to(1'000'000));
  const auto before = elapsed();
  const auto late = client.call("axis.wait", {{"axis", "x"}, {"timeout_ms", 1'500}});
  EXPECT_EQ(late.at("error").at("data").at("name").as_string(), "deadline_passed");
  EXPECT_NEAR(elapsed() - before, 1.5, 0.01);
}

TEST_F(OwnGatewayTest, WhatIsWatchedIsToldInItsOrderAndNothingIsLeftOut) {
  RpcClient client(socket());
  client.call("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 20}});
  client.call("axis.move_to", to(200'000));
  client.call("axis.wait", of_x);
  std::int64_t last = -1;
  int count = 0;
  for (auto said = client.notification("notify_state"); said.is_object();
       said = client.notification("notify_state")) {
    const auto& state = said.as_object();
    EXPECT_GE(state.at("position_microsteps").as_int64(), last);
    EXPECT_EQ(state.at("dropped").as_int64(), 0);
    last = state.at("position_microsteps").as_int64();
    ++count;
  }
  EXPECT_GT(count, 50);
}

TEST(OwnGatewayConfig, HasNoDoorsToClientsInTheirOwnTime) {
  const auto path = tmcl::test::temp_path("own_gateway.toml");
  const std::string least = "[daemon]\nsocket = \"/none\"\n";
  std::ofstream(path) << least;
  EXPECT_TRUE(load_gateway_config(path));
  std::ofstream(path) << least << "[http]\nlisten = [\"127.0.0.1:0\"]\n";
  const auto refused = load_gateway_config(path);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().front(), HasSubstr("leave [http] and [[port]] out"));
  std::filesystem::remove(path);
}

class OwnGatewayByCan : public OwnGatewayTest {
 protected:
  OwnGatewayByCan() : OwnGatewayTest("can:none") {}
};

TEST_F(OwnGatewayByCan, ReachesTheSameModules) {
  RpcClient client(socket());
  client.call("axis.move_to", to(1'000));
  EXPECT_EQ(client.call("axis.wait", of_x).at("result").at("position_microsteps").as_int64(),
            1'000);
}

class OwnGatewayWithDeadman : public OwnGatewayTest {
 protected:
  OwnGatewayWithDeadman()
      : OwnGatewayTest(serial_link,
                       "[[module]]\nbus = \"bench\"\naddress = 1\ndeadman_ms = 500\n") {}
};

TEST_F(OwnGatewayWithDeadman, FeedsItAsTimeGoesOn) {
  RpcClient client(socket());
  client.call("axis.move_to", to(500'000));
  run_for("5");
  EXPECT_TRUE(client.call("axis.wait", of_x).contains("result"));
}

}  // namespace
}  // namespace tmclsim
