// What becomes of axes that move when the gateway ends.
#include <gmock/gmock.h>

#include "gateway/ending.hpp"
#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using tmcl::Command;

class Ending : public testing::Test {
 protected:
  void begin(const std::string& on_exit) {
    bench_ = std::make_unique<MovesBench>(true, Limits::none, on_exit);
  }
  void set_off(json::object how) {
    bench_->client->result("axis.rotate", std::move(how));
    bench_->daemon.run_for(1s);
  }
  std::int32_t velocity_of_x() {
    const auto reply =
        bench_->daemon.wire().modules.at(1).execute({tmcl::ModuleAddress{1}, Command::GAP, 3});
    return reply.value;
  }
  json::object rotation(bool unattended) {
    return {{"axis", "x"}, {"velocity_internal", 500'000}, {"unattended", unattended}};
  }
  std::size_t stops() { return bench_->daemon.requests_seen(Command::MST); }

  std::unique_ptr<MovesBench> bench_;
};

TEST_F(Ending, WithStopComesWhenWhatMovesStands) {
  begin("stop");
  set_off(rotation(true));
  EXPECT_NE(velocity_of_x(), 0);
  bench_->daemon.end();
  EXPECT_EQ(velocity_of_x(), 0);
}

TEST_F(Ending, WithKeepLetsUnattendedAxesTurn) {
  begin("keep");
  set_off(rotation(true));
  bench_->daemon.end();
  EXPECT_EQ(stops(), 0U);
  EXPECT_NE(velocity_of_x(), 0);
}

TEST_F(Ending, WithKeepStopsWhatTurnsForAClient) {
  begin("keep");
  set_off(rotation(false));
  bench_->daemon.end();
  EXPECT_EQ(stops(), 1U);
}

TEST_F(Ending, WaitsNoLongerThanItSaysForAnAxisThatDoesNotStand) {
  begin("stop");
  set_off(rotation(true));
  bench_->daemon.wire().loses = [](const auto& request) { return request.command == Command::GAP; };
  const auto began = bench_->daemon.now();
  bench_->daemon.end();
  EXPECT_GE(bench_->daemon.now() - began, time_to_stand);
  EXPECT_LT(bench_->daemon.now() - began, time_to_stand + 3s);
}

}  // namespace
}  // namespace tmcld::test
