// What happens beside a path: links that are lost, modules that fall silent, others who want the
// reactor and the bus.
#include <boost/asio/post.hpp>
#include "gateway/axis/poller.hpp"
#include "gateway/journey/reconnect_grace.hpp"
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

TEST_F(DaemonPath, ALinkThatComesBackIsUsedToStop) {
  const auto id = client->send("path.run", order(long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  daemon.on_reactor([&] {
    daemon.wire().unplug();
    return 0;
  });
  const auto error = error_of(id);
  EXPECT_EQ(name_in(error), "command_failed");
  EXPECT_TRUE(error.at("data").at("run").at("remarks").as_array().empty())
      << json::serialize(error);
  expect_rest_and_own_settings();
}

TEST_F(DaemonPath, ALinkThatComesBackIsUsedToSetBack) {
  const auto id = client->send("path.run", order(long_way, {{"mode", "position"}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  bool stopped = false;
  bool lost = false;
  on_module([&](Played& played) {
    played.before = [&](const tmcl::Request& request) {
      stopped = stopped || request.command == Command::MST;
      if (!stopped || lost || request.command != Command::SAP) return;
      lost = true;
      boost::asio::post(daemon.daemon().context(), [&] { daemon.wire().unplug(); });
    };
    return 0;
  });
  RpcClient other(daemon.socket());
  other.result("path.stop");
  EXPECT_TRUE(error_of(id).at("data").at("run").at("remarks").as_array().empty());
  EXPECT_TRUE(on_module([&](Played&) { return lost; }));
  expect_rest_and_own_settings();
  on_module([](Played& played) { return played.before = {}, 0; });
}

class DaemonPathWithoutLink : public DaemonPath {
 protected:
  void lose_link() {
    daemon.on_reactor([&] {
      daemon.wire().is_absent = true;
      return daemon.wire().unplug(), 0;
    });
  }
  static constexpr const char* both_may_move =
      "axis 'x' could not be stopped and may still move; "
      "axis 'y' could not be stopped and may still move";
};

TEST_F(DaemonPathWithoutLink, NobodyIsToldThatItsAxesStand) {
  RpcClient watching(daemon.socket());
  watching.result("subscribe", {{"axes", json::array{}}});
  RpcClient other(daemon.socket());
  const auto id = client->send("path.run", order(long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  lose_link();
  const auto asked = daemon.now();
  const auto stop = other.error("path.stop");
  EXPECT_LT(daemon.now() - asked, time_for_link * 3 / 2) << "waited once";
  EXPECT_EQ(name_in(stop), "not_stopped");
  EXPECT_EQ(text(stop.at("message")), both_may_move);
  EXPECT_EQ(text(stop.at("data").at("outcome")), "unknown");
  EXPECT_EQ(json::serialize(stop.at("data").at("unstopped")), R"(["x","y"])");

  const auto run = error_of(id);
  EXPECT_THAT(text(run.at("message")), HasSubstr(both_may_move));
  EXPECT_THAT(text(run.at("data").at("hint")), testing::Not(HasSubstr("were stopped")));
  EXPECT_EQ(text(run.at("data").at("outcome")), "unknown");
  EXPECT_EQ(json::serialize(run.at("data").at("unstopped")), R"(["x","y"])");

  auto news = watching.notification("notify_event");
  while (text(news.at("kind")) != "path_broken") news = watching.notification("notify_event");
  EXPECT_THAT(text(news.at("text")), HasSubstr(both_may_move));
  EXPECT_THAT(text(news.at("text")), testing::Not(HasSubstr("\n"))) << "a log has lines";
  daemon.wire().is_absent = false;
}

TEST_F(DaemonPathWithoutLink, ALinkThatComesBackLateIsUsedToStop) {
  const auto id = client->send("path.run", order("G1 X1000 Y500 F1200\n"));
  ASSERT_TRUE(until_x_is_beyond(2));
  lose_link();
  error_of(id);
  EXPECT_TRUE(on_module([](Played& played) { return played.moves(); }));
  client->result("subscribe", {{"axes", json::array{}}});
  daemon.on_reactor([&] { return daemon.wire().is_absent = false; });
  for (int axis = 0; axis < 2;) {
    if (text(client->notification("notify_event").at("kind")) == "axis_stopped") ++axis;
  }
  EXPECT_FALSE(on_module([](Played& played) { return played.moves(); }));
}

/// Counts how often the reactor takes up a next piece of work until another request goes out, by
/// being one of them.
class Turns : public std::enable_shared_from_this<Turns> {
 public:
  static constexpr std::size_t most = 2000;

  Turns(boost::asio::io_context& context, const FakeWire& wire)
      : context_(context), wire_(wire), seen_(wire.seen.size()) {}
  void take() {
    boost::asio::post(context_, [self = shared_from_this()] {
      if (self->wire_.seen.size() > self->seen_ || self->count_ == most) return;
      ++self->count_;
      self->take();
    });
  }
  std::size_t count() const { return count_; }

 private:
  boost::asio::io_context& context_;
  const FakeWire& wire_;
  std::size_t seen_;
  std::size_t count_ = 0;
};

// Before its stream begins, it is looked at a million times for how steep it is.
TEST_F(DaemonPath, WhileALongPathIsPreparedOthersHaveTheirTurn) {
  std::shared_ptr<Turns> turns;
  std::size_t turns_in_preparation = 0;
  module.before = [&](const tmcl::Request& request) {
    // The last that is measured, and the first that is asked when that is known.
    if (turns && request.type == ap::max_acceleration) turns_in_preparation = turns->count();
    turns.reset();
    if (request.type != ap::actual_position) return;
    turns = std::make_shared<Turns>(daemon.daemon().context(), daemon.wire());
    turns->take();
  };
  const auto id = client->send("path.run", order("G1 X40 Y10 F0.05\n"));
  ASSERT_TRUE(daemon.eventually([&] { return turns_in_preparation > 0; }));
  RpcClient other(daemon.socket());
  other.result("path.stop");
  EXPECT_EQ(name_in(error_of(id)), "stopped");
  module.before = {};
  // One after a thousand looks each; an exchange alone takes some.
  EXPECT_GE(turns_in_preparation, 900U);
}

TEST_F(DaemonPath, WhoWatchesItsAxesGetsLessOfTheBus) {
  constexpr std::uint8_t read_by_watchers_only = ap::position_reached;
  std::size_t looks = 0;
  on_module([&](Played& played) {
    played.before = [&](const tmcl::Request& request) {
      const bool reads = request.command == Command::GAP && request.motor == 0;
      if (reads && request.type == read_by_watchers_only) ++looks;
    };
    return 0;
  });
  client->result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 5}});
  const auto id = client->send("path.run", order(long_way));
  const auto look_at = [&](double position) {
    EXPECT_TRUE(until_x_is_beyond(position));
    return on_module([&](Played&) { return std::pair(looks, daemon.now()); });
  };
  const auto [looks_before, begin] = look_at(2);
  const auto [looks_after, end] = look_at(35);
  EXPECT_GT(looks_after, looks_before);
  const auto ticks = (end - begin) / shortest_poll_interval_beside_path + 1;
  EXPECT_LE(looks_after - looks_before, static_cast<std::size_t>(ticks) + 1) << "one may be late";
  EXPECT_TRUE(client->answer_to(id).contains("result"));
  on_module([](Played& played) { return played.before = {}, 0; });
}

TEST_F(DaemonPath, ASilentModuleIsTold) {
  const auto id = client->send("path.run", order(long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  daemon.on_reactor([&] {
    daemon.wire().holds = true;
    return 0;
  });
  const auto error = error_of(id);
  EXPECT_EQ(name_in(error), "command_failed");
  EXPECT_THAT(json::serialize(error.at("data").at("run").at("remarks")),
              HasSubstr("x could not be stopped"));
  daemon.on_reactor([&] { return daemon.wire().release(), 0; });
}

}  // namespace
}  // namespace tmcld::test
