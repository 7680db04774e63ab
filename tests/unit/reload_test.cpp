// Another configuration for a daemon that runs: all of it, or nothing.
#include <gmock/gmock.h>

#include <set>
#include <string>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>

#include "support/temp_path.hpp"
#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const std::string other_bus = "[[bus]]\nname = \"other\"\nlink = \"serial:/dev/other@115200\"\n";

std::string on_other_bus(const std::string& name) {
  return "[[axis]]\nname = \"" + name + "\"\nbus = \"other\"\naddress = 1\nmotor = 0\n";
}

class Reload : public testing::Test {
 protected:
  explicit Reload(const std::string& more = {})
      : daemon_(x_and_y() + other_bus + on_other_bus("u") + more, reactor_) {
    module_.be_played_by(daemon_.wire().modules.at(1));
    other_module_.be_played_by(daemon_.wire("other").modules.at(1));
    daemon_.start();
    client_ = std::make_unique<RpcClient>(daemon_.socket());
  }

  /// What has become of it: the line, or the lines of what is wrong.
  std::string reload(const std::string& toml, const std::string& keys = {}) {
    const auto config =
        parse_config("[daemon]\nsocket = \"" + daemon_.socket().path + "\"\n" + keys + toml);
    if (!config) return config.error().front().message;
    std::optional<tl::expected<std::string, std::vector<std::string>>> reloaded;
    const auto run = [&]() -> boost::asio::awaitable<void> {
      auto result = co_await Daemon::reload(daemon_.daemon(), *config);
      reloaded.emplace(std::move(result));
    };
    boost::asio::co_spawn(daemon_.daemon().context(), run, boost::asio::detached);
    EXPECT_TRUE(daemon_.eventually([&] { return reloaded.has_value(); }));
    return *reloaded ? **reloaded : reloaded->error().front();
  }
  json::object result(std::string_view method, json::object params) {
    return client_->result(method, std::move(params));
  }
  std::string error(std::string_view method, json::object params) {
    return std::string(client_->error(method, std::move(params)).at("data").at("name").as_string());
  }
  bool is_moving(std::string_view axis) {
    return result("axis.get_state", {{"axis", axis}}).at("moving").as_bool();
  }
  GatewayBus* bench() { return daemon_.daemon().gateway().find_bus("bench"); }

  static std::string x_and_y() { return axes_x_and_y(Limits::none); }

 private:
  std::shared_ptr<VirtualReactor> reactor_ = std::make_shared<VirtualReactor>();
  SimulatedModule module_{reactor_->clock};
  SimulatedModule other_module_{reactor_->clock};

 protected:
  TestDaemon daemon_;
  std::unique_ptr<RpcClient> client_;
};

TEST_F(Reload, LeavesAloneWhatIsSaidAsBefore) {
  const auto* before = bench();
  EXPECT_EQ(reload(x_and_y() + other_bus + on_other_bus("u")),
            "buses: 2 as before, 0 opened anew, 0 new, 0 gone; axes: 3");
  EXPECT_EQ(bench(), before);
}

TEST_F(Reload, AddsAnAxisToABusAtRest) {
  const auto z = axis_section("z", 2);
  EXPECT_EQ(reload(x_and_y() + z + other_bus + on_other_bus("u")),
            "buses: 1 as before, 1 opened anew, 0 new, 0 gone; axes: 4");
  EXPECT_TRUE(daemon_.eventually([&] { return bench()->state() == GatewayBus::State::open; }));
  result("axis.move_to", {{"axis", "z"}, {"position_microsteps", 1000}});
  EXPECT_TRUE(daemon_.eventually([&] { return !is_moving("z"); }));
}

TEST_F(Reload, RefusesAllWhileAnAxisMovesThatItWouldChange) {
  result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 10'000'000}});
  daemon_.run_for(100ms);
  const auto* before = bench();
  EXPECT_THAT(reload(x_and_y() + axis_section("z", 2)), HasSubstr("axis 'x' moves"));
  EXPECT_EQ(bench(), before);
  EXPECT_EQ(daemon_.daemon().gateway().axes().size(), 3U);
  EXPECT_TRUE(is_moving("x"));
}

TEST_F(Reload, LetsAnAxisMoveOnABusThatItLeavesAlone) {
  result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 10'000'000}});
  daemon_.run_for(100ms);
  EXPECT_EQ(reload(x_and_y()), "buses: 1 as before, 0 opened anew, 0 new, 1 gone; axes: 2");
  EXPECT_TRUE(is_moving("x"));
  EXPECT_EQ(error("axis.get_state", {{"axis", "u"}}), "unknown_axis");
  EXPECT_EQ(reload(x_and_y() + other_bus + on_other_bus("v")),
            "buses: 1 as before, 0 opened anew, 1 new, 0 gone; axes: 3");
  EXPECT_TRUE(daemon_.eventually([&] {
    return daemon_.daemon().gateway().find_bus("other")->state() == GatewayBus::State::open;
  }));
  result("axis.get_state", {{"axis", "v"}});
}

TEST_F(Reload, RefusesWhatIsLeasedOrTurns) {
  const auto lease = result("lease.acquire", {{"axes", json::array{"y"}}, {"ttl_ms", 60'000}});
  EXPECT_THAT(reload(other_bus + on_other_bus("u")), HasSubstr("axis 'y' is leased by process"));
  result("lease.release", {{"lease", lease.at("lease")}, {"epoch", lease.at("epoch")}});
  result("axis.rotate", {{"axis", "y"}, {"velocity_internal", 5000}, {"unattended", true}});
  EXPECT_THAT(reload(other_bus + on_other_bus("u")), HasSubstr("axis 'y' turns"));
  result("axis.stop", {{"axis", "y"}});
  daemon_.run_for(1s);
  EXPECT_EQ(reload(other_bus + on_other_bus("u")),
            "buses: 1 as before, 0 opened anew, 0 new, 1 gone; axes: 1");
}

class ReloadAtPort : public Reload {
 protected:
  ReloadAtPort() : Reload(at_port()) {}
  static std::string at_port() {
    return "[[port]]\nname = \"a\"\nbus = \"other\"\npty = \"" +
           tmcl::test::temp_path("reload.pty") + "\"\n";
  }
};

TEST_F(ReloadAtPort, OpensNoBusAnewThatAProgramHas) {
  EXPECT_THAT(reload(x_and_y() + other_bus + on_other_bus("v") + at_port()),
              HasSubstr("bus 'other' is at port 'a'"));
  EXPECT_EQ(daemon_.daemon().gateway().axes().size(), 3U);
  EXPECT_EQ(reload(x_and_y() + axis_section("z", 2) + other_bus + on_other_bus("u") + at_port()),
            "buses: 1 as before, 1 opened anew, 0 new, 0 gone; axes: 4");
}

TEST_F(Reload, RefusesWhatTakesARestart) {
  EXPECT_THAT(reload(x_and_y(), "audit = \"/tmp/elsewhere\"\n"),
              HasSubstr("'audit' in [daemon] has changed, which takes a restart"));
  EXPECT_EQ(daemon_.daemon().gateway().axes().size(), 3U);
}

TEST_F(Reload, TakesOverWhatHoldsForAll) {
  reload(x_and_y(), "moves_need_lease = true\n");
  EXPECT_EQ(error("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}}), "not_permitted");
}

TEST_F(Reload, GoesOnTellingOfTheAxesThatHaveTheNamesNow) {
  // By its name, by the address of its motor, and as one of all.
  const auto by_name = result("subscribe", {{"axes", json::array{"x"}}}).at("subscription");
  const auto raw = result("subscribe", {{"axes", json::array{"bench:1/2"}}}).at("subscription");
  const auto begun = result("subscribe", {});
  const auto of_all = begun.at("subscription");
  const auto seq = begun.at("states").at(0).at("seq").as_int64();
  EXPECT_THAT(reload(x_and_y() + axis_section("v", 2) + other_bus), HasSubstr("2 opened anew"));
  ASSERT_TRUE(daemon_.eventually([&] { return bench()->state() == GatewayBus::State::open; }));
  for (const auto* axis : {"x", "v"})
    result("axis.move_to", {{"axis", axis}, {"position_microsteps", 1000}});
  std::set<std::string> told;
  const auto name_of = [](const json::value& subscription, const json::value& axis) {
    return json::serialize(subscription) + json::serialize(axis);
  };
  const auto is_told = [&](const json::value& subscription, const char* axis) {
    return told.contains(name_of(subscription, axis));
  };
  for (int i = 0; i < 100; ++i) {
    const auto state = client_->notification("notify_state");
    told.insert(name_of(state.at("subscription"), state.at("axis")));
    if (state.at("axis") == "x") {
      EXPECT_GT(state.at("seq").as_int64(), seq);
    }
    if (is_told(by_name, "x") && is_told(raw, "v") && is_told(of_all, "x") && is_told(of_all, "v"))
      break;
  }
  EXPECT_TRUE(is_told(by_name, "x"));
  EXPECT_TRUE(is_told(raw, "v"));
  EXPECT_TRUE(is_told(of_all, "x"));
  EXPECT_TRUE(is_told(of_all, "v")) << "it was not there when that began";
  EXPECT_FALSE(is_told(of_all, "u")) << "it is not there any more";
  for (const auto& subscription : {by_name, raw, of_all})
    result("unsubscribe", {{"subscription", subscription}});
}

TEST_F(Reload, IsToldToThoseWhoWatch) {
  result("subscribe", {{"axes", json::array{"x"}}});
  const auto words = reload(x_and_y() + other_bus + on_other_bus("u"));
  const auto event = client_->notification("notify_event");
  EXPECT_EQ(event.at("kind"), "configuration_loaded");
  EXPECT_EQ(event.at("text").as_string(), words);
  EXPECT_EQ(event.at("bus"), "");
}

TEST_F(Reload, TellsThatABusIsGone) {
  result("subscribe", {{"axes", json::array{"x"}}});
  reload(x_and_y());
  const auto event = client_->notification("notify_event");
  EXPECT_EQ(event.at("kind"), "link_lost");
  EXPECT_EQ(event.at("bus"), "other");
}

}  // namespace
}  // namespace tmcld::test
