// A client that floods a bus leaves room in its queue for all others.
#include <gmock/gmock.h>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using tmcl::Effect;

constexpr auto room = tmcl::max_queued_calls;

TEST(QueueShares, OneAloneHasHalfOfTheRoomOfEachKind) {
  QueueShares shares;
  std::vector<QueueShares::Place> places;
  for (const auto kind : {Effect::reads, Effect::moves}) {
    while (auto place = shares.take(1, kind)) places.push_back(std::move(place));
    EXPECT_EQ(places.size(), kind == Effect::reads ? room / 2 : room);
  }
  EXPECT_FALSE(shares.take(1, Effect::writes)) << "that acts, too";
  EXPECT_TRUE(shares.take(1, Effect::stops));
  EXPECT_TRUE(shares.take(0, Effect::reads)) << "the gateway itself";
  places.clear();
  EXPECT_TRUE(shares.take(1, Effect::reads));
}

TEST(QueueShares, WhoHasNothingWaitingFindsRoomHoweverManyFlood) {
  for (const std::uint64_t clients : {2U, 5U, 20U, 200U}) {
    QueueShares shares;
    std::vector<QueueShares::Place> places;
    for (bool goes_on = true; std::exchange(goes_on, false);) {
      for (std::uint64_t client = 1; client <= clients; ++client) {
        auto place = shares.take(client, Effect::reads);
        if (!place) continue;
        places.push_back(std::move(place));
        goes_on = true;
      }
    }
    EXPECT_LT(places.size(), room) << clients;
    EXPECT_TRUE(shares.take(clients + 1, Effect::reads));
  }
}

TEST(QueueShares, WhatIsAskedTogetherIsLetInTogether) {
  QueueShares shares;
  const auto first = shares.take(1, Effect::reads, room - 1);
  EXPECT_TRUE(first);
  EXPECT_FALSE(shares.take(1, Effect::reads));
  EXPECT_TRUE(shares.take(2, Effect::reads, 20));
}

class Flood : public testing::Test {
 protected:
  void flood(std::size_t count, const char* command) {
    bench_.wire.delay = std::chrono::milliseconds(1);
    bench_.client = flooder_;
    for (std::size_t i = 0; i < count; ++i)
      bench_.begin_call("module.execute",
                        {{"bus", "bench"},
                         {"address", 1},
                         {"command", command},
                         {"type", 4 + i % 100},
                         {"motor", i / 100 % 3},
                         {"value", i}},
                        flood_);
    bench_.time.settle();
    bench_.client = other_;
  }
  std::size_t refused() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        flood_, [](const auto& result) { return !result && result.error().name == "queue_full"; }));
  }

  std::vector<Result<boost::json::object>> flood_;
  VirtualGateway bench_;
  Client flooder_ = bench_.gateway().add_client("flooder");
  Client other_ = bench_.gateway().add_client("other");
};

TEST_F(Flood, CostsNobodyElseAReading) {
  flood(300, "GAP");
  const auto read = bench_.call("parameter.get", {{"axis", "x"}, {"parameter", "max_current"}});
  EXPECT_TRUE(read) << read.error().message;
  bench_.time.run_for(std::chrono::minutes(1));
  EXPECT_GT(refused(), 100U);
}

TEST_F(Flood, CostsNobodyElseASetting) {
  flood(300, "SAP");
  const auto set =
      bench_.call("parameter.set", {{"axis", "x"}, {"parameter", "max_current"}, {"value", 5}});
  EXPECT_TRUE(set) << set.error().message;
  EXPECT_GT(refused(), 0U);
}

TEST_F(Flood, IsNoReasonNotToStop) {
  flood(300, "GAP");
  EXPECT_TRUE(bench_.call("axis.stop", {{"axis", "x"}}));
}

}  // namespace
}  // namespace tmcld::test
