// A cable that is out for a while as axes are on their way along a path or a line: whatever could
// not be stopped is when the cable is back, and nobody is told otherwise.
#include <gmock/gmock.h>

#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/json/serialize.hpp>

#include "api/dispatch.hpp"
#include "async/spawn.hpp"
#include "config/load.hpp"
#include "gateway/gateway.hpp"
#include "log/log.hpp"
#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/wire.hpp"
#include "world/world.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;
namespace ap = tmcl::axis_parameter;

constexpr auto config_text = R"(
[daemon]
socket = "/none"
[[bus]]
name = "bench"
link = "serial:/dev/none@115200"
[[axis]]
name = "x"
bus = "bench"
address = 1
motor = 0
unit = "mm"
units_per_revolution = 5
[[axis]]
name = "y"
bus = "bench"
address = 1
motor = 1
unit = "mm"
units_per_revolution = 5
)";

/// Two axes of a simulated TMCM-6212 behind a cable.
class Cable : public testing::Test {
 protected:
  Cable()
      : wire(context_, "bench", tmcl::Framing::serial, 1, {}, trace_),
        module_(wire.bench().add(*tmcl::find_model("TMCM-6212"), tmcl::ModuleAddress{1})) {
    std::signal(SIGPIPE, SIG_IGN);
    silence_log();
    GatewayOptions options;
    options.open_link = [this](const BusConfig&) { return wire.open(); };
    gateway_ = Gateway::create(context_.get_executor(), parse_config(config_text).value(),
                               std::move(options));
    gateway_->on_event([this](const GatewayEvent& event) {
      if (event.kind == GatewayEvent::Kind::axis_stopped) stopped.push_back(event.text);
    });
    gateway_->start();
    time.run_for(1s);
    for (const char* axis : {"x", "y"}) {
      for (const auto& [parameter, value] :
           {std::pair{4, 240'000}, {5, 4'999'922}, {17, 4'999'922}})
        call("parameter.set", {{"axis", axis}, {"parameter", parameter}, {"value", value}});
    }
  }
  ~Cable() override {
    gateway_->close();
    time.run_for(10s);
  }

  using Answer = std::shared_ptr<std::optional<RpcResult>>;

  Answer begin(std::string_view method, json::object params) {
    auto answer = std::make_shared<std::optional<RpcResult>>();
    auto carry_out = [](auto gateway, auto peer, RpcRequest request,
                        Answer into) -> boost::asio::awaitable<void> {
      auto result = co_await dispatch(std::move(gateway), std::move(peer), std::move(request));
      *into = std::move(result);
    };
    const RpcRequest request{1, find_method(method), std::move(params)};
    spawn(context_.get_executor(), carry_out(gateway_, peer_, request, answer));
    return answer;
  }
  RpcResult end(const Answer& answer) {
    EXPECT_TRUE(time.run_while_not([&] { return answer->has_value(); }, 1h));
    return std::move(**answer);
  }
  RpcResult call(std::string_view method, json::object params) {
    return end(begin(method, std::move(params)));
  }
  Answer begin_path() {
    const auto path = begin("path.run", {{"axes", json::array{"x", "y"}},
                                         {"text", "G1 X20 Y10 F1200\nG1 X900 Y0\n"},
                                         {"deviation", 900}});
    EXPECT_TRUE(time.run_while_not([&] { return mm(0) > 12; }, 1min));
    return path;
  }

  std::int32_t get(std::uint8_t motor, std::uint8_t parameter) {
    wire.bench().run_due();
    return *module_.axis(motor).get(parameter);
  }
  double mm(std::uint8_t motor) { return get(motor, ap::actual_position) / (51'200 / 5.0); }
  bool moves() { return get(0, ap::actual_velocity) != 0 || get(1, ap::actual_velocity) != 0; }
  tmcl::Duration time_to_stand() {
    const auto began = time.now();
    EXPECT_TRUE(time.run_while_not([&] { return !moves(); }, 1min));
    return time.now() - began;
  }
  std::string name_of_error(const RpcResult& result) {
    return result ? "none" : std::string(result.error().data.at("name").as_string());
  }

 private:
  boost::asio::io_context context_{1};

 public:
  tmcl::VirtualTime time{context_};

 private:
  Trace trace_;

 public:
  Wire wire;
  std::vector<std::string> stopped;

 private:
  tmcl::sim::Module& module_;
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<Peer> peer_ = std::make_shared<WorldPeer>(trace_);
};

TEST_F(Cable, OutForTwoSecondsOnAPathStopsItsAxesWhenItIsBack) {
  const auto path = begin_path();
  wire.is_cut = true;
  const auto back = time.now() + 2s;
  const auto result = end(path);
  ASSERT_LT(time.now(), back) << "who asked is not kept waiting";
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().data.at("outcome"), "unknown") << json::serialize(result.error().data);
  EXPECT_EQ(json::serialize(result.error().data.at("unstopped")), R"(["x","y"])");
  EXPECT_THAT(result.error().message, HasSubstr("may still move"));
  EXPECT_THAT(json::serialize(result.error().data), Not(HasSubstr("were stopped")));
  time.run_until(back);
  EXPECT_TRUE(moves());
  EXPECT_TRUE(stopped.empty());
  wire.is_cut = false;
  EXPECT_LT(time_to_stand(), 1200ms);
  time.run_for(1s);
  EXPECT_THAT(stopped, testing::UnorderedElementsAre("axis 'x' stands now", "axis 'y' stands now"));
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 0}}));
}

TEST_F(Cable, OutForAMinuteKeepsOthersFromMovingTheAxesUntilTheyStand) {
  const auto path = begin_path();
  wire.is_cut = true;
  end(path);
  time.run_for(60s);
  wire.is_cut = false;
  // The module answers again before its axes have been stopped.
  ASSERT_TRUE(time.run_while_not([&] { return !stopped.empty() || !moves(); }, 10s));
  std::vector<std::string> errors;
  while (stopped.size() < 2) {
    const std::size_t before = stopped.size();
    const auto move = call("axis.move_to", {{"axis", "y"}, {"position_microsteps", 0}});
    if (stopped.size() == before && before == 0) errors.push_back(name_of_error(move));
    time.run_for(1ms);
  }
  for (const auto& error : errors)
    EXPECT_THAT(error, testing::AnyOf("axis_claimed", "module_silent"));
}

TEST_F(Cable, WhateverIsSaidOfAxesThatWereStoppedIsTrue) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<int> random(seed);
  for (int round = 0; round < tmcl::test::rounds(4) && !HasFailure(); ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    for (const char* axis : {"x", "y"})
      call("axis.move_to", {{"axis", axis}, {"position_microsteps", 0}});
    time.run_for(100s);
    stopped.clear();
    const auto path = begin_path();
    time.run_for(std::chrono::microseconds(random.between(0, 20'000)));
    wire.is_cut = true;
    const auto back = time.now() + std::chrono::milliseconds(random.any_size(3'000));
    const auto look = [&] {
      if (time.now() >= back) wire.is_cut = false;
      return path->has_value();
    };
    while (!look()) time.run_for(1ms);
    const auto& result = **path;
    // A moment that nobody noticed.
    if (result) {
      EXPECT_FALSE(moves());
      continue;
    }
    const bool all_stand = !result.error().data.contains("unstopped");
    EXPECT_FALSE(all_stand && moves()) << json::serialize(result.error().data);
    EXPECT_EQ(result.error().data.at("outcome"), all_stand ? "done" : "unknown");
    time.run_until(back);
    wire.is_cut = false;
    EXPECT_LT(time_to_stand(), 1200ms);
    time.run_for(2s);
    EXPECT_EQ(stopped.size(),
              all_stand ? 0U : result.error().data.at("unstopped").as_array().size());
  }
}

}  // namespace
}  // namespace tmcld::test
