// Whichever allocation of a call fails, the call has an end, everybody else is served, and nothing
// moves but what the call was to move.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include "api/method.hpp"
#include "memory/allocations.hpp"
#include "memory/bench.hpp"
#include "memory/method_calls.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;

TEST(MemoryOfMethods, EachHasACallHere) {
  for (const auto& method : method_table()) {
    EXPECT_NE(std::ranges::find(method_calls(), method.name, &MethodCall::method),
              method_calls().end())
        << method.name;
  }
}

/// With what the call before has given.
std::string filled(std::string_view params, const json::object& before) {
  std::string text(params);
  for (auto at = text.find("\"$"); at != std::string::npos; at = text.find("\"$")) {
    const auto end = text.find('"', at + 1);
    const auto name = text.substr(at + 2, end - at - 2);
    text.replace(at, end + 1 - at, json::serialize(before.at("result").at(name)));
  }
  return text;
}

/// Makes a call again and again, and another allocation fails each time.
class Sweep {
 public:
  explicit Sweep(const MethodCall& call) : call_(call), random_(tmcl::test::seed()) {}

  void run() {
    for (std::uint64_t n = 1;; n = after(n)) {
      SCOPED_TRACE(std::string(call_.method) + ", allocation " + std::to_string(n));
      const bool has_failed = attempt(n);
      if (testing::Test::HasFailure()) return;
      failures_ += has_failed ? 1 : 0;
      if (!has_failed) break;
    }
    EXPECT_GT(failures_, 20) << "a request is read, and an answer is written";
  }

 private:
  /// Each of the first ones; then fewer and fewer, at random.
  std::uint64_t after(std::uint64_t n) {
    constexpr std::uint64_t all_until = 50;
    if (n < all_until) return n + 1;
    return n + static_cast<std::uint64_t>(random_.between(1, static_cast<std::int64_t>(n / 5)));
  }

  /// Whether there were so many allocations.
  bool attempt(std::uint64_t n) {
    if (!bench_) bench_ = std::make_unique<MemoryBench>();
    auto client = std::make_unique<MemoryClient>(*bench_);
    const auto params = prepare(*client);
    const auto before = bench_->positions();
    client->send(call_.method, params);
    fail_allocation(n);
    const bool has_end = bench_->run_until(
        [&] { return client->answer() || client->is_cut_off() || bench_->has_failed(); }, 60s);
    const bool has_failed = end_failures();
    EXPECT_TRUE(has_end) << "no answer";
    if (!has_failed) {
      const auto answer = client->answer().value_or(json::object());
      EXPECT_NE(answer.contains("result"), call_.ends_by_error) << json::serialize(answer);
    }
    if (!bench_->has_failed()) {
      client.reset();
      if (!call_.is_last) expect_service();
    }
    EXPECT_TRUE(has_failed || !bench_->has_failed()) << "there was memory";
    if (bench_->has_failed()) expect_end();
    expect_others_stood(before);
    if (bench_->has_failed() || call_.is_last) bench_.reset();
    return has_failed;
  }

  std::string prepare(MemoryClient& client) {
    json::object result;
    for (const auto& one : call_.before) {
      if (one.goes_on) {
        client.send(one.method, one.params);
        bench_->run_for(1s);
      } else {
        result = client.call(one.method, one.params);
        EXPECT_TRUE(result.contains("result")) << one.method << json::serialize(result);
      }
    }
    return result.contains("result") || result.empty() ? filled(call_.params, result) : "{}";
  }

  /// What that does to axes that move is in stops_test.cpp.
  void expect_end() {
    EXPECT_TRUE(bench_->run_until([&] { return bench_->daemon().has_ended(); }, 500s));
    EXPECT_TRUE(bench_->run_until([&] { return !bench_->moves(); }, 10s));
  }

  /// A movement that goes on behind its answer may end the daemon, too, once its axes stand.
  void expect_service() {
    MemoryClient other(*bench_);
    const auto expect_done = [&](std::string_view method, std::string_view params) {
      const auto answer = other.call(method, params);
      EXPECT_TRUE(answer.contains("result") || bench_->has_failed())
          << method << ' ' << json::serialize(answer);
    };
    expect_done("axis.get_state", R"({"axis":"z"})");
    expect_done("axis.stop", R"({"axis":"x"})");
    expect_done("system.stop_all", "{}");
    for (const auto* name : {"bench", "other"})
      other.call("token.revoke", R"({"name":")" + std::string(name) + R"("})");
    auto& gateway = bench_->daemon().gateway();
    // A plan goes on to its end, also if its client was cut off.
    const auto is_quiet = [&] {
      return gateway.planning.taken() == 0 && !bench_->moves() && !gateway.has_journeys() &&
             gateway.stops_in_progress == 0 && gateway.uploads.empty() &&
             gateway.buses().front()->queued() == 0;
    };
    EXPECT_TRUE(bench_->run_until(is_quiet, 30s))
        << "moves: " << bench_->moves() << ", stops: " << gateway.stops_in_progress
        << ", waiting: " << gateway.buses().front()->queued();
    if (bench_->has_failed()) return;
    for (const auto* axis : {"x", "y", "z"})
      expect_done("axis.recover", R"({"axis":")" + std::string(axis) + "\"}");
    const auto lease = other.call("lease.acquire", R"({"axes":["x","y","z"],"ttl_ms":60000})");
    EXPECT_TRUE(lease.contains("result")) << json::serialize(lease);
    EXPECT_EQ(gateway.planning.taken(), 0U);
    bench_->run_for(100ms);
  }

  void expect_others_stood(const std::vector<std::int32_t>& before) {
    const auto after = bench_->positions();
    for (std::size_t motor = 0; motor < MemoryBench::motors; ++motor) {
      if (std::ranges::find(call_.moves, motor) != call_.moves.end()) continue;
      EXPECT_EQ(after[motor], before[motor]) << "motor " << motor;
    }
  }

  const MethodCall& call_;
  tmcl::test::Random<> random_;
  std::unique_ptr<MemoryBench> bench_;
  int failures_ = 0;
};

class MemoryOfMethod : public testing::TestWithParam<std::size_t> {};

TEST_P(MemoryOfMethod, IsMissingAnywhereAndTheCallHasAnEnd) {
  Sweep(method_calls()[GetParam()]).run();
}

std::string name_of(const testing::TestParamInfo<std::size_t>& info) {
  std::string name(method_calls()[info.param].method);
  std::ranges::replace(name, '.', '_');
  return name + "_" + std::to_string(info.param);
}

INSTANTIATE_TEST_SUITE_P(All, MemoryOfMethod, testing::Range(std::size_t{0}, method_calls().size()),
                         name_of);

}  // namespace
}  // namespace tmcld::test
