// Clients that send anything at all, beside one that works: every line that comes back is a proper
// one, the process lives, and the one that works does not notice.
#include <array>
#include <atomic>
#include <ctime>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include <boost/asio/steady_timer.hpp>

#include "api/request.hpp"
#include "api/staging.hpp"
#include "async/spawn.hpp"
#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/hex.hpp"
#include "unit/threaded_daemon.hpp"

namespace tmcld::test {
namespace {

// A thread simulates its module, and a busy machine may keep that waiting: so the timeout is out of
// reach. What floods cost is measured by the reactor's processor time.
constexpr std::string_view other_bus = R"(
[[bus]]
name = "other"
link = "serial:/dev/other@115200"
reply_timeout_ms = 30000
[[axis]]
name = "worker"
bus = "other"
address = 1
motor = 0
)";

// Of the reactor's own processor time, so that a busy machine makes little difference: lines of the
// greatest length take some milliseconds, the longest path some 20. What is a hundred times the
// work of a line is beyond it.
#ifdef __SANITIZE_ADDRESS__
constexpr auto longest_turn = std::chrono::milliseconds(500);  // not optimised, and checked
#else
constexpr auto longest_turn = std::chrono::milliseconds(200);
#endif

/// Measures on the reactor how long it works between two looks at what is due.
class TurnMeter {
 public:
  explicit TurnMeter(ThreadedDaemon& daemon) : daemon_(daemon) {
    daemon_.on_reactor([this] {
      spawn(daemon_.daemon().context().get_executor(), measure());
      return 0;
    });
  }
  ~TurnMeter() {
    daemon_.on_reactor([this] { return ending_ = true; });
    while (!daemon_.on_reactor([this] { return ended_; })) std::this_thread::yield();
  }
  /// Since it was asked last.
  tmcl::Duration longest() {
    return daemon_.on_reactor([this] { return std::exchange(longest_, tmcl::Duration{}); });
  }

 private:
  static tmcl::Duration processor_time() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
  }
  boost::asio::awaitable<void> measure() {
    boost::asio::steady_timer timer(daemon_.daemon().context());
    auto before = processor_time();
    while (!ending_) {
      timer.expires_after(std::chrono::milliseconds(1));
      co_await timer.async_wait(boost::asio::use_awaitable);
      const auto now = processor_time();
      longest_ = std::max(longest_, now - before);
      before = now;
    }
    ended_ = true;
  }

  ThreadedDaemon& daemon_;
  tmcl::Duration longest_{};
  bool ending_ = false;
  bool ended_ = false;
};

/// The client that works, on a bus of its own.
class Worker {
 public:
  explicit Worker(const DaemonSocket& socket) : client_(socket), thread_([this] { work(); }) {}
  ~Worker() { finish(); }
  void finish() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
  }
  int moves() const { return moves_; }

 private:
  void work() {
    const json::object axis{{"axis", "worker"}};
    try {
      while (!ending_) {
        auto move = axis;
        move["position_microsteps"] = ++moves_;
        client_.result("axis.move_to", move);
        const auto there = client_.result("axis.wait", axis).at("position_microsteps");
        EXPECT_EQ(there, moves_.load());
        client_.result("axis.stop", axis);
      }
    } catch (const std::exception& error) {
      ADD_FAILURE() << "after " << moves_ << " moves: " << error.what();
    }
  }

  RpcClient client_;
  std::atomic<bool> ending_ = false;
  std::atomic<int> moves_ = 0;
  std::thread thread_;
};

/// What hostile clients send.
class Lines {
 public:
  explicit Lines(std::uint64_t seed) : random_(seed) {}

  std::string any() {
    switch (random_.between(0, 8)) {
      case 0:
        return request(json::value(text(random_.any_size(2 * max_line_bytes))), "axis.list", {});
      case 1: return request(id(), text(random_.any_size(max_line_bytes)), {});
      case 2: return request(id(), method().name, long_array());
      case 3: return nested(static_cast<std::size_t>(random_.any_size(max_line_bytes / 2)));
      case 4: return garbage();
      case 5: return about_as_long_as_a_line();
      case 6: return damaged(ordinary());
      default: return ordinary();
    }
  }
  /// As many requests as may be in progress, of those with the longest answers.
  std::string flood() {
    static constexpr std::array<std::string_view, 3> longest{"rpc.discover", "parameter.list",
                                                             "subscribe"};
    std::string lines;
    for (std::size_t i = 0; i < max_requests_in_flight; ++i) {
      const auto method = longest[static_cast<std::size_t>(random_.between(0, 2))];
      json::object params;
      if (method == "parameter.list") params["axis"] = "x";
      lines += request(static_cast<std::int64_t>(i), method, params) + '\n';
    }
    return lines;
  }
  std::size_t below(std::size_t limit) {
    return static_cast<std::size_t>(random_.between(0, static_cast<std::int64_t>(limit) - 1));
  }
  bool one_in(int n) { return random_.one_in(n); }

 private:
  static std::string request(const json::value& id, std::string_view method,
                             const json::object& params) {
    return json::serialize(
        json::object{{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}});
  }
  std::string ordinary() {
    const auto& row = method();
    return request(id(), row.name, params_for(row));
  }
  std::string text(std::int64_t bytes) {
    static constexpr std::array<std::string_view, 5> letters{"a", "\x01", "\"", "\u20ac", "\\"};
    std::string all;
    const auto letter = letters[below(letters.size())];
    while (all.size() < static_cast<std::size_t>(bytes)) all += letter;
    return all;
  }
  json::value id() {
    if (one_in(2)) return random_.either_way(random_.any_size(INT64_MAX / 2));
    return json::value(text(random_.any_size(2 * max_id_bytes)));
  }
  // What everybody may do to the one who works, such as a stop of all, is left out, and a scan,
  // which takes half a minute.
  const MethodInfo& method() {
    const auto methods = method_table();
    while (true) {
      const auto& row = methods[below(methods.size())];
      if (row.name == "system.stop_all" || row.name == "bus.scan") continue;
      return row;
    }
  }
  json::value number() {
    switch (random_.between(0, 3)) {
      case 0: return random_.either_way(random_.any_size(INT64_MAX / 2));
      case 1: return random_.between(0, 255);
      case 2: return static_cast<double>(random_.any_size(INT64_MAX / 2)) / 7;
      default: return 1e300;
    }
  }
  json::value value_for(const api::Field& row) {
    if (one_in(20)) return json::value(text(random_.any_size(2'000)));
    if (row.name == "axis") return one_in(2) ? "x" : "y";
    if (row.name == "bus") return "bench";
    if (row.name == "address") return 1;
    if (row.name == "axes") return json::array{"x", "y"};
    switch (row.type) {
      case api::FieldType::boolean: return one_in(2);
      case api::FieldType::integer:
        return one_in(2) ? json::value(random_.between(row.minimum, row.maximum)) : number();
      case api::FieldType::integers: return json::array{random_.between(0, 40)};
      case api::FieldType::quantity:
        return one_in(2) ? json::value(number()) : json::value(text(40));
      case api::FieldType::quantities: return json::array{number(), text(40)};
      case api::FieldType::text_or_integer: return random_.between(0, 255);
      case api::FieldType::text: return json::value(text(2 * random_.any_size(2'000)));
      default: return number();
    }
  }
  json::object params_for(const MethodInfo& row) {
    json::object all;
    for (const auto& param : row.params) {
      const bool waits = param.name == "timeout_ms" || param.name == "deadline_ms";
      if (waits) all[param.name] = random_.between(0, 20);
      if (!waits && (param.required || one_in(2))) all[param.name] = value_for(param);
    }
    return all;
  }
  json::object long_array() {
    json::array many;
    const auto count = random_.any_size(static_cast<std::int64_t>(max_line_bytes / 2));
    const bool numbers = one_in(2);
    for (std::int64_t i = 0; i < count; ++i)
      many.push_back(numbers ? json::value(1) : json::value("x"));
    return {{one_in(2) ? "axes" : "positions_microsteps", std::move(many)}};
  }
  static std::string nested(std::size_t depth) {
    return R"({"jsonrpc":"2.0","id":1,"method":"bus.list","params":{"a":)" +
           std::string(depth, '[') + std::string(depth, ']') + "}}";
  }
  std::string garbage() {
    std::string all;
    for (auto left = random_.any_size(200); left > 0; --left)
      all += static_cast<char>(random_.between(-128, 127));
    return all;
  }
  std::string about_as_long_as_a_line() {
    auto line = request(id(), "bus.list", {});
    const auto size = max_line_bytes - 3 + below(6);
    if (line.size() < size) line.append(size - line.size(), ' ');
    return line;
  }
  std::string damaged(std::string line) {
    for (auto changes = random_.between(1, 4); changes > 0; --changes)
      line[below(line.size())] = static_cast<char>(random_.between(-128, 127));
    return line;
  }

  tmcl::test::Random<> random_;
};

class SessionFuzz : public testing::Test {
 protected:
  SessionFuzz() { daemon.start(); }

  /// Everything that comes is a proper line. Ends when the answer to a last request is there.
  void read_all(RpcClient& client) {
    const std::string last = "\n{\"jsonrpc\":\"2.0\",\"id\":\"last\",\"method\":\"axis.list\"}\n";
    client.send_raw(last);
    bool asks_again = false;
    while (const auto line = client.read_line()) {
      ASSERT_LT(line->size(), max_answer_bytes);
      boost::system::error_code error;
      const auto message = json::parse(*line, error);
      ASSERT_FALSE(error) << line->substr(0, 200);
      ASSERT_EQ(message.at("jsonrpc"), "2.0");
      const auto* id = message.as_object().if_contains("id");
      if (id == nullptr) continue;
      // Too much is in progress: when something of it has ended there is room again.
      if (std::exchange(asks_again, false)) client.send_raw(last);
      if (*id != "last") continue;
      if (!is_overload(message)) return;
      asks_again = true;
    }
    // Only for what it had sent before and not read.
    ASSERT_TRUE(client.is_cut_off()) << "no answer";
  }
  static bool is_overload(const json::value& message) {
    const auto* error = message.as_object().if_contains("error");
    return error != nullptr && error->at("code") == -32001;
  }

  void be_hostile(RpcClient& client) {
    if (lines.one_in(8)) {
      client.send_raw(lines.flood());
    } else {
      for (auto count = lines.below(6); count > 0; --count) client.send_raw(lines.any() + '\n');
    }
    if (!lines.one_in(3)) return;
    const auto line = lines.any();
    client.send_raw(std::string_view(line).substr(0, lines.below(line.size() + 1)));
  }

  static void tell(tmcl::Duration turn) {
    std::cout << "longest turn of the reactor: "
              << std::chrono::duration<double, std::milli>(turn).count() << " ms" << std::endl;
  }

  ThreadedDaemon daemon{two_axes() + std::string(other_bus)};
  Lines lines{tmcl::test::seed()};
};

TEST_F(SessionFuzz, CostsNobodyElseAnything) {
  TurnMeter meter(daemon);
  Worker worker(daemon.socket());
  auto hostile = std::make_unique<RpcClient>(daemon.socket());
  tmcl::Duration longest{};
  for (int round = 0; round < tmcl::test::rounds(400); ++round) {
    SCOPED_TRACE(round);
    be_hostile(*hostile);
    if (lines.one_in(2)) read_all(*hostile);
    if (lines.one_in(4)) hostile = std::make_unique<RpcClient>(daemon.socket());
    ASSERT_FALSE(testing::Test::HasFailure());
    const auto turn = meter.longest();
    ASSERT_LT(turn, longest_turn);
    longest = std::max(longest, turn);
  }
  worker.finish();
  tell(longest);
  EXPECT_GT(worker.moves(), 0);
  EXPECT_EQ(RpcClient(daemon.socket()).result("axis.list").at("axes").as_array().size(), 3U);
}

// ---- the largest legal path --------------------------------------------------------------------

/// As long as a path may be.
std::string longest_path() {
  std::string text = "x,y\n";
  text.reserve(staged_path.most_bytes);
  while (text.size() + 16 <= staged_path.most_bytes) text += "0.0000,0.00000\n";
  return text;
}

TEST_F(SessionFuzz, TheLongestPathIsOneOfThem) {
  TurnMeter meter(daemon);
  Worker worker(daemon.socket());
  RpcClient hostile(daemon.socket());
  const auto text = longest_path();
  constexpr std::size_t part = 30'000;
  for (std::size_t offset = 0; offset < text.size(); offset += part) {
    const auto piece = std::string_view(text).substr(offset, part);
    const std::vector<std::uint8_t> bytes(piece.begin(), piece.end());
    hostile.result("path.stage", {{"offset", offset}, {"data", tmcl::to_hex(bytes)}});
  }
  const auto handing_over = meter.longest();
  tell(handing_over);
  EXPECT_LT(handing_over, longest_turn);
  const auto before = worker.moves();
  const auto answer =
      hostile.call("path.run", {{"axes", json::array{"x", "y"}}, {"bytes", text.size()}});
  EXPECT_TRUE(answer.contains("error"));
  const auto running = meter.longest();
  tell(running);
  EXPECT_LT(running, longest_turn);
  EXPECT_GT(worker.moves(), before);
}

}  // namespace
}  // namespace tmcld::test
