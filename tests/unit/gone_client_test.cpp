// What becomes of what a client has asked for when it goes.
#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <vector>

#include "async/spawn.hpp"
#include "unit/journey_bench.hpp"
#include "world/world_peer.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using tmcl::Command;

class GoneClient : public JourneyBench, public testing::Test {
 protected:
  using Answer = std::shared_ptr<std::optional<Result<json::object>>>;

  std::shared_ptr<WorldPeer> client() {
    auto peer = std::make_shared<WorldPeer>(trace_);
    peer->number = gateway->add_client("client").number;
    return peer;
  }
  Answer begin(const std::shared_ptr<WorldPeer>& peer, std::string_view method,
               json::object params) {
    auto answer = std::make_shared<std::optional<Result<json::object>>>();
    auto carry_out = [](auto of, auto by, RpcRequest request,
                        Answer into) -> boost::asio::awaitable<void> {
      auto result = co_await dispatch(std::move(of), std::move(by), std::move(request));
      *into = std::move(result);
    };
    const RpcRequest request{1, find_method(method), std::move(params)};
    spawn(gateway->buses().front()->executor(), carry_out(gateway, peer, request, answer));
    return answer;
  }
  /// Reads that wait for the bus, one behind the other.
  std::vector<Answer> begin_reads(const std::shared_ptr<WorldPeer>& peer) {
    std::vector<Answer> reads;
    for (const auto* axis : {"y", "z"})
      for (int parameter = 0; parameter < 12; ++parameter)
        reads.push_back(begin(peer, "parameter.get", {{"axis", axis}, {"parameter", parameter}}));
    return reads;
  }
  void be_ready() {
    for (const auto* axis : {"x", "y", "z"}) call("axis.get_state", {{"axis", axis}});
    time.run_for(1s);
    requests.clear();
  }

 private:
  Trace trace_;
};

TEST_F(GoneClient, AsksNothingMore) {
  be_ready();
  const auto one = client();
  const auto reads = begin_reads(one);
  time.settle();
  ASSERT_LE(requests.size(), 1U);
  gateway->remove_client(one->number);
  time.run_for(1s);
  EXPECT_LE(requests.size(), 1U) << "what was under way";
  for (const auto& read : reads) EXPECT_TRUE(read->has_value());
}

TEST_F(GoneClient, HasItsSettingsWrittenAllTheSame) {
  be_ready();
  const auto one = client();
  begin_reads(one);
  begin(one, "parameter.set", {{"axis", "x"}, {"parameter", "max_current"}, {"value", 77}});
  begin(one, "global.set",
        {{"bus", "line"}, {"address", 1}, {"bank", 2}, {"parameter", 9}, {"value", 5}});
  time.settle();
  gateway->remove_client(one->number);
  time.run_for(1s);
  EXPECT_EQ(get("x", 6), 77);
  EXPECT_EQ(sent(Command::SGP).size(), 1U);
}

TEST_F(GoneClient, LeavesALookAtAnAxisToTheOthersThatWaitForIt) {
  be_ready();
  const auto one = client();
  const auto other = client();
  const auto first = begin(one, "axis.get_state", {{"axis", "x"}});
  const auto second = begin(other, "axis.get_state", {{"axis", "x"}});
  const auto third = begin(other, "axis.get_state", {{"axis", "x"}});
  time.run_for(1ms);
  gateway->remove_client(one->number);
  time.run_for(1s);
  ASSERT_TRUE(first->has_value());
  EXPECT_FALSE(**first);
  for (const auto& answer : {second, third}) {
    ASSERT_TRUE(answer->has_value());
    EXPECT_TRUE(**answer) << (**answer).error().message;
  }
}

TEST_F(GoneClient, KeepsNoOtherWaiting) {
  be_ready();
  for (int i = 0; i < 20; ++i) {
    const auto one = client();
    begin_reads(one);
    time.run_for(1ms);
    gateway->remove_client(one->number);
  }
  const auto asked = time.now();
  const auto state = begin(client(), "axis.get_state", {{"axis", "x"}});
  time.run_while_not([&] { return state->has_value(); }, 1min);
  ASSERT_TRUE(state->has_value());
  EXPECT_TRUE(**state);
  EXPECT_LT(time.now() - asked, 200ms);
}

}  // namespace
}  // namespace tmcld::test
