// As many axes as can be configured, all with the longest names there can be, and each with
// something to complain of: what concerns all of them can still be told.
#include <set>

#include <gmock/gmock.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

constexpr std::size_t buses = 8;
constexpr int motors = 4;
constexpr std::size_t longest_name = 32;

/// Of the greatest length, and different.
std::string name_of(std::string_view kind, std::size_t number) {
  auto name = std::string(kind) + std::to_string(number) + "_";
  return name + std::string(longest_name - name.size(), 'n');
}

std::string all_axes() {
  std::string toml;
  for (std::size_t i = 0; i < buses; ++i)
    toml += "[[bus]]\nname = \"" + name_of("bus", i) + "\"\nlink = \"serial:/dev/none" +
            std::to_string(i) + "@115200\"\n";
  for (std::size_t i = 0; i < max_axes; ++i) {
    const auto on_bus = i / buses;
    toml += "[[axis]]\nname = \"" + name_of("axis", i) + "\"\nbus = \"" +
            name_of("bus", i % buses) + "\"\naddress = " + std::to_string(1 + on_bus / motors) +
            "\nmotor = " + std::to_string(on_bus % motors) + "\n";
  }
  return toml;
}

class ManyAxes : public testing::Test {
 protected:
  ManyAxes() {
    for (std::size_t i = 0; i < buses; ++i) {
      auto& wire = daemon.wire(name_of("bus", i));
      wire.is_absent = true;
      // A link may be a path of 4096 bytes.
      wire.why_absent = "cannot open " + std::string(4096, 'p');
    }
    daemon.start(false);
    client = std::make_unique<RpcClient>(daemon.socket());
    const auto has_failed = [](const auto& bus) { return !bus->error().empty(); };
    EXPECT_TRUE(daemon.eventually(
        [&] { return std::ranges::all_of(daemon.daemon().gateway().buses(), has_failed); }));
  }

  static void expect_each_failed(const json::object& result) {
    const auto& failed = result.at("failed").as_array();
    ASSERT_EQ(failed.size(), max_axes);
    std::set<std::string> names;
    for (const auto& entry : failed) {
      names.insert(text(entry.at("axis")));
      EXPECT_EQ(text(entry.at("error").at("data").at("name")), "link_lost");
      EXPECT_EQ(text(entry.at("error").at("data").at("outcome")), "not_sent");
    }
    EXPECT_EQ(names.size(), max_axes);
  }

  TestDaemon daemon{all_axes()};
  std::unique_ptr<RpcClient> client;
};

TEST_F(ManyAxes, AStopOfAllThatFailsSaysSoOfEach) {
  const auto result = client->result("system.stop_all");
  EXPECT_TRUE(result.at("stopped").as_array().empty());
  expect_each_failed(result);
}

TEST_F(ManyAxes, ASubscriptionToAllIsToldAndCanBeEnded) {
  const auto result = client->result("subscribe");
  expect_each_failed(result);
  EXPECT_EQ(result.at("subscription"), 1);
  client->result("unsubscribe", {{"subscription", 1}});
}

TEST_F(ManyAxes, AsManySuchAnswersAsCanBeAskedForAtOnceAreRead) {
  std::vector<int> stops;
  for (std::size_t i = 0; i < max_requests_in_flight; ++i)
    stops.push_back(client->send("system.stop_all"));
  for (const int id : stops) expect_each_failed(client->answer_to(id).at("result").as_object());
}

}  // namespace
}  // namespace tmcld::test
