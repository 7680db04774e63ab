// Where there is no memory at all, what moves is stopped: the stops take none.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "last_stop.hpp"
#include "memory/allocations.hpp"
#include "memory/bench.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using tmcl::Command;

constexpr std::size_t y = 1;
constexpr std::size_t z = 2;

class MemoryOfStops : public testing::Test {
 protected:
  void turn(MemoryClient& client) {
    for (const auto* axis : {"y", "z"}) {
      const auto params = R"({"axis":")" + std::string(axis) + R"(","velocity_internal":300})";
      const auto answer = client.call("axis.rotate", params);
      ASSERT_TRUE(answer.contains("result")) << json::serialize(answer);
    }
    bench->run_for(500ms);
    ASSERT_TRUE(turns(y) && turns(z));
    bench->requests.clear();
  }
  bool turns(std::size_t motor) {
    return bench->get(motor, tmcl::axis_parameter::actual_velocity) != 0;
  }
  bool is_told_to_stop(std::size_t motor) const {
    return std::ranges::any_of(bench->requests, [&](const tmcl::Request& request) {
      return request.command == Command::MST && number(request.address) == 2 &&
             request.motor == motor - 1;
    });
  }
  bool are_told_to_stop() const { return is_told_to_stop(y) && is_told_to_stop(z); }
  /// There is memory again.
  void expect_end() {
    end_failures();
    bench->daemon().on_failure(std::make_exception_ptr(std::bad_alloc()));
    EXPECT_TRUE(bench->run_until([&] { return bench->daemon().has_ended(); }, 500s));
    EXPECT_FALSE(bench->moves());
  }
  bool movement_follows_stops() const {
    const auto& all = bench->requests;
    const auto stop = std::ranges::find(all, Command::MST, &tmcl::Request::command);
    return std::find_if(stop, all.end(), [](const tmcl::Request& request) {
             return request.command == Command::MVP || request.command == Command::ROR;
           }) != all.end();
  }
  /// In a process of its own: it may end by std::terminate(), and the stops must be out then, too.
  template <class Scene>
  void expect_stops(Scene scene) {
    EXPECT_EXIT(
        {
          scene_of = this;
          std::set_terminate([] { std::_Exit(scene_of->has_stopped() ? 0 : 1); });
          const LastStop last_stop(bench->daemon().gateway());
          scene();
          std::_Exit(has_stopped() && !HasFailure() ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
  }
  bool has_stopped() {
    end_failures();
    bench->listen();
    return are_told_to_stop() && !movement_follows_stops();
  }
  static inline MemoryOfStops* scene_of = nullptr;

  std::unique_ptr<MemoryBench> bench = std::make_unique<MemoryBench>();
};

TEST_F(MemoryOfStops, IsNotNeededToStopWhatMovesWhenTheReactorThrows) {
  MemoryClient client(*bench);
  turn(client);
  expect_stops([&] {
    bench->let_reactor_throw();
    fail_allocation(1, true);
    EXPECT_TRUE(bench->run_until([&] { return are_told_to_stop(); }, 1s));
    EXPECT_TRUE(bench->run_until([&] { return !bench->moves(); }, 5s)) << "without any memory";
    expect_end();
  });
}

TEST_F(MemoryOfStops, IsNotNeededToKeepWhatWaitsFromMoving) {
  MemoryClient client(*bench);
  turn(client);
  expect_stops([&] {
    std::vector<std::unique_ptr<MemoryClient>> others;
    for (int i = 0; i < 20; ++i) {
      auto& other = *others.emplace_back(std::make_unique<MemoryClient>(*bench));
      other.send("axis.move_to",
                 R"({"axis":"x","position_microsteps":)" + std::to_string(1000 + i) + "}");
    }
    bench->run_for(5ms);
    bench->let_reactor_throw();
    fail_allocation(1, true);
    EXPECT_TRUE(bench->run_until([&] { return are_told_to_stop(); }, 1s));
    expect_end();
  });
}

/// From any allocation on that a stop takes, there is no memory any more.
TEST_F(MemoryOfStops, IsNotNeededForAStopThatAClientAsksFor) {
  MemoryClient client(*bench);
  turn(client);
  for (const auto* method : {"axis.stop", "system.stop_all"}) {
    for (std::uint64_t n = 1; n < 150 && !HasFailure(); ++n) {
      SCOPED_TRACE(std::string(method) + " from allocation " + std::to_string(n) + " on");
      expect_stops([&] {
        if (method == std::string("axis.stop")) client.call("axis.stop", R"({"axis":"z"})");
        client.send(method, method == std::string("axis.stop") ? R"({"axis":"y"})" : "{}");
        fail_allocation(n, true);
        EXPECT_TRUE(bench->run_until([&] { return are_told_to_stop(); }, 1s));
      });
    }
  }
}

}  // namespace
}  // namespace tmcld::test
