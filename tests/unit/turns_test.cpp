// A client that only reads gets its turn, whatever others ask of the bus.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;

/// While so many others write. A state takes 14 questions in 9 steps: 4 about the motor, the 2
/// units together, 2 about the driver, each after the answer to the one before, and twice 3
/// together about whether it turns. Each of the others writes, and reads for its warnings, so that
/// a question waits for the exchange that is under way and for one of each of both; one more of the
/// same step for these alone. An answer may have to wait for the fence that proves it, which comes
/// after 8 answers: 7 more, and the fence.
std::size_t most_exchanges_of_a_state(std::size_t clients) {
  constexpr std::size_t steps = 9;
  constexpr std::size_t questions = 14;
  const auto others = 2 * clients;
  return (1 + others + 1 + 8) * steps + (others + 1) * (questions - steps);
}

class Turns : public testing::Test {
 protected:
  Turns() { bench_.wire.delay = 10ms; }

  /// Clients that keep so many settings in progress each.
  void flood(std::size_t clients, std::size_t each) {
    for (std::size_t i = 0; i < clients; ++i) {
      bench_.client = bench_.gateway().add_client("flooder " + std::to_string(i));
      for (std::size_t one = 0; one < each; ++one)
        bench_.begin_call("parameter.set",
                          {{"axis", one % 2 == 0 ? "x" : "y"},
                           {"parameter", "max_velocity"},
                           {"value", 1000 + one}},
                          answers_);
    }
    bench_.client = bench_.gateway().add_client("reader");
    bench_.time.run_for(300ms);
  }
  /// How many exchanges there were while this was asked.
  std::size_t exchanges_of(const char* method, json::object params) {
    bench_.wire.seen.clear();
    const auto result = bench_.call(method, std::move(params));
    EXPECT_TRUE(result) << result.error().message;
    return bench_.wire.seen.size();
  }

  std::vector<Result<boost::json::object>> answers_;
  VirtualGateway bench_;
};

TEST_F(Turns, OfAReaderComeHoweverMuchOneOtherWrites) {
  flood(1, 16);
  EXPECT_LE(exchanges_of("parameter.get", {{"axis", "y"}, {"parameter", "max_current"}}), 12U);
  EXPECT_LE(exchanges_of("axis.get_state", {{"axis", "y"}}), most_exchanges_of_a_state(1));
}

TEST_F(Turns, OfAReaderComeHoweverManyWrite) {
  flood(4, 64);
  EXPECT_LE(exchanges_of("parameter.get", {{"axis", "y"}, {"parameter", "max_current"}}), 20U);
  EXPECT_LE(exchanges_of("axis.get_state", {{"axis", "y"}}), most_exchanges_of_a_state(4));
}

TEST_F(Turns, OfAReaderComeInABoundedNumberOfExchanges) {
  const auto seed = tmcl::test::seed();
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
  tmcl::test::Random<std::size_t> random(seed);
  const auto clients = random.between(1, 6);
  flood(clients, random.between(1, 64));
  for (int i = 0; i < 20; ++i) {
    // Each of the others has at most three kinds of calls, and so has the gateway.
    EXPECT_LE(exchanges_of("parameter.get", {{"axis", "y"}, {"parameter", "max_current"}}),
              8 * (clients + 1) + 8);
  }
}

}  // namespace
}  // namespace tmcld::test
