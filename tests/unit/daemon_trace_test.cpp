// bus.trace: what the gateway has sent and got, for whichever client.
#include <gmock/gmock.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::StartsWith;

class DaemonTrace : public testing::Test {
 protected:
  json::object trace(json::object params = {}) {
    params["bus"] = "line";
    return bench.call("bus.trace", std::move(params)).value();
  }
  static std::uint64_t number(const json::object& from, std::string_view key) {
    return from.at(key).to_number<std::uint64_t>();
  }

  JourneyBench bench;
};

TEST_F(DaemonTrace, HasRequestsAndReplies) {
  const auto before = number(trace(), "last");
  EXPECT_EQ(bench.get("x", 4), 1000);
  const auto traffic = trace({{"after", before}});
  const auto& datagrams = traffic.at("datagrams").as_array();
  ASSERT_GE(datagrams.size(), 2U);
  const auto& request = datagrams[datagrams.size() - 2].as_object();
  const auto& reply = datagrams.back().as_object();
  EXPECT_EQ(request.at("direction"), "out");
  EXPECT_EQ(request.at("bytes"), "01060400000000000b");
  EXPECT_FALSE(request.contains("client")) << "this one has no number";
  EXPECT_FALSE(request.contains("can_id"));
  EXPECT_EQ(reply.at("direction"), "in");
  EXPECT_THAT(std::string(reply.at("bytes").as_string()), StartsWith("02016406"));
  EXPECT_GE(reply.at("utc_us").as_int64(), request.at("utc_us").as_int64());
  EXPECT_EQ(number(reply, "number"), number(traffic, "last"));
  EXPECT_EQ(number(traffic, "dropped"), 0U);
}

TEST_F(DaemonTrace, GivesTheNewestUnlessItIsToldWhatIsKnown) {
  bench.position("x");
  const auto traffic = trace({{"limit", 2}});
  EXPECT_EQ(traffic.at("datagrams").as_array().size(), 2U);
  EXPECT_EQ(number(traffic.at("datagrams").at(1).as_object(), "number"), number(traffic, "last"));
  EXPECT_EQ(trace({{"after", number(traffic, "last")}}).at("datagrams").as_array().size(), 0U);
  EXPECT_EQ(trace({{"after", 1'000'000}}).at("datagrams").as_array().size(), 0U)
      << "numbers of an earlier tmcld";
  EXPECT_EQ(number(trace({{"after", 0}, {"limit", 1}}).at("datagrams").at(0).as_object(), "number"),
            1U);
}

TEST_F(DaemonTrace, SaysHowManyAreForgotten) {
  for (int i = 0; i < 3000; ++i) bench.position("x");
  const auto traffic = trace({{"after", 1}});
  EXPECT_EQ(number(traffic, "dropped"), number(traffic, "last") - 4096 - 1);
  EXPECT_EQ(traffic.at("datagrams").as_array().size(), 256U);
}

TEST_F(DaemonTrace, NamesABusThatThereIsNot) {
  const auto result = bench.call("bus.trace", {{"bus", "lin"}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().name, "unknown_bus");
}

TEST_F(DaemonTrace, ClientsAreRememberedByTheirNames) {
  const auto first = bench.gateway->add_client("process 1");
  EXPECT_EQ(bench.gateway->name_of_client(first.number), "process 1");
  bench.gateway->remove_client(first.number);
  EXPECT_EQ(bench.gateway->name_of_client(first.number), "process 1");
  for (int i = 0; i < 1000; ++i)
    bench.gateway->remove_client(bench.gateway->add_client("another").number);
  EXPECT_EQ(bench.gateway->name_of_client(first.number), "client " + std::to_string(first.number));
}

}  // namespace
}  // namespace tmcld::test
