// A command that was let out waits for its turn on the bus; meanwhile what it was let out on
// changes. It is judged again when its bytes go out.
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using tmcl::Command;

class LastMoment : public testing::Test {
 protected:
  LastMoment() {
    bench_.wire.delay = 1ms;
    bench_.client = mover_;
  }

  /// Begins the call of `mover_` behind a question that is under way, and lets all go on when
  /// `meanwhile` is done. Gives the error of the call; empty: there is none.
  std::string name_of_error(std::string_view method, const json::object& params,
                            const std::function<void()>& meanwhile) {
    // So the timer of the module need not be asked before the command.
    EXPECT_TRUE(bench_.call("axis.get_state", {{"axis", "x"}}));
    bench_.wire.holds = true;
    bench_.begin_call("parameter.get", {{"axis", "y"}, {"parameter", "max_current"}}, asked_);
    bench_.time.settle();
    bench_.begin_call(method, params, results_);
    bench_.time.settle();
    EXPECT_EQ(queued(), 1U) << "the command waits for its turn";
    meanwhile();
    bench_.wire.holds = false;
    bench_.wire.release();
    bench_.time.run_for(5s);
    EXPECT_EQ(results_.size(), 1U);
    if (results_.empty() || results_.front()) return "";
    return results_.front().error().name;
  }
  std::string error_of_move(const std::function<void()>& meanwhile) {
    return name_of_error("axis.move_to",
                         {{"axis", "x"}, {"position_microsteps", 500}, {"predict", false}},
                         meanwhile);
  }
  std::string error_of_setting(const std::function<void()>& meanwhile) {
    return name_of_error("parameter.set",
                         {{"axis", "x"}, {"parameter", "max_current"}, {"value", 100}}, meanwhile);
  }
  std::size_t queued() { return bench_.gateway().buses().front()->queued(); }
  std::size_t moves() const { return bench_.wire.count(Command::MVP); }
  std::size_t settings() const { return bench_.wire.count(Command::SAP); }

  void take_lease() {
    bench_.client = other_;
    std::vector<Result<boost::json::object>> granted;
    bench_.begin_call("lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 60'000}}, granted);
    bench_.time.settle();
    ASSERT_EQ(granted.size(), 1U);
    ASSERT_TRUE(granted.front()) << granted.front().error().message;
  }

  VirtualGateway bench_;
  Client mover_ = bench_.gateway().add_client("mover");
  Client other_ = bench_.gateway().add_client("other");
  std::vector<Result<boost::json::object>> asked_;
  std::vector<Result<boost::json::object>> results_;
};

TEST_F(LastMoment, ACommandGoesOutWhereNothingHasChanged) {
  EXPECT_EQ(error_of_move([] {}), "");
  EXPECT_EQ(moves(), 1U);
}

TEST_F(LastMoment, NothingMovesAnAxisThatWasLeasedMeanwhile) {
  EXPECT_EQ(error_of_move([this] { take_lease(); }), "leased");
  EXPECT_EQ(moves(), 0U);
}

TEST_F(LastMoment, NothingSetsAnAxisThatWasLeasedMeanwhile) {
  EXPECT_EQ(error_of_setting([this] { take_lease(); }), "leased");
  EXPECT_EQ(settings(), 0U);
}

TEST_F(LastMoment, NothingMovesForAClientThatHasGoneMeanwhile) {
  EXPECT_NE(error_of_move([this] { bench_.gateway().remove_client(mover_.number); }), "");
  EXPECT_EQ(moves(), 0U);
}

TEST_F(LastMoment, NothingMovesAnAxisThatWasClaimedMeanwhile) {
  std::optional<Claim> claim;
  const auto name = error_of_move([&] {
    const auto& axis = bench_.gateway().axes().front();
    claim = axis->claim({ClaimKind::path, bench_.gateway().admit(other_.number)});
  });
  EXPECT_EQ(name, "axis_claimed");
  EXPECT_EQ(moves(), 0U);
}

TEST_F(LastMoment, NothingMovesAnAxisThatWasLatchedMeanwhile) {
  const auto name = error_of_move([&] {
    auto& motors = bench_.gateway().buses().front()->motors();
    motors.latch(tmcl::ModuleAddress{1}, "module 1 has started again");
  });
  EXPECT_EQ(name, "latched");
  EXPECT_EQ(moves(), 0U);
}

TEST_F(LastMoment, AStopIsLetThroughWhateverHasChanged) {
  const auto name = name_of_error("axis.stop", {{"axis", "x"}}, [this] { take_lease(); });
  EXPECT_EQ(name, "");
  EXPECT_EQ(bench_.wire.count(Command::MST), 1U);
}

}  // namespace
}  // namespace tmcld::test
