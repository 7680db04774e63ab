// Whichever allocation fails behind a connection by HTTP, a WebSocket or a port: its client is
// answered or cut off, or the daemon stops what moves and ends; everybody else is served. A host on
// a pseudo terminal or on CAN cannot be cut off: what it says next is answered.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "memory/allocations.hpp"
#include "memory/bench.hpp"
#include "memory/port_peers.hpp"
#include "memory/tcp_peer.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::Command;

enum class Door : std::uint8_t { http, tcp, pty, can };

/// What a client says, and what it hears when no allocation fails.
struct Talk {
  std::string name;
  Door door = Door::http;
  std::string before{};  ///< Said and answered while there is memory; empty: it has just come.
  std::string request{};
  std::string answer{};
  bool stops = false;  ///< What another client turns.
};

std::string get(const std::string& target, const std::string& more = {}) {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost:$\r\n" + more + "\r\n";
}

std::string call(const std::string& method, const std::string& params) {
  return R"({"jsonrpc":"2.0","id":7,"method":")" + method + R"(","params":)" + params + "}";
}

std::string post(const std::string& body) {
  return "POST /rpc HTTP/1.1\r\nHost: localhost:$\r\nContent-Type: application/json\r\n"
         "Content-Length: " +
         std::to_string(body.size()) + "\r\n\r\n" + body;
}

const std::string upgrade =
    get("/ws",
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n");

/// A masked text, as RFC 6455, 5.2 wants it of a client; its mask is 0.
std::string frame(const std::string& text) {
  constexpr std::size_t most_in_short_head = 125;
  EXPECT_LE(text.size(), most_in_short_head);
  return std::string("\x81") + static_cast<char>(0x80U | text.size()) + std::string(4, '\0') + text;
}

std::string datagram(Command command, std::uint8_t type, std::int32_t value = 0) {
  const auto bytes = encode_serial(tmcl::Request{tmcl::ModuleAddress{2}, command, type, 0, value});
  return {bytes.begin(), bytes.end()};
}

std::string success(Command command) {
  return {2, static_cast<char>(tmcl::Status::ok), static_cast<char>(command)};
}

std::vector<Talk> talks() {
  const auto state = call("axis.get_state", R"({"axis":"y"})");
  const auto move = call("axis.move_to", R"({"axis":"y","position_microsteps":512})");
  const auto stop = call("axis.stop", R"({"axis":"z"})");
  const auto asked = datagram(Command::GAP, tmcl::axis_parameter::actual_position);
  const auto moved = datagram(Command::MVP, 0, 512);
  const auto stopped = encode_serial(tmcl::Request{tmcl::ModuleAddress{2}, Command::MST, 0, 1, 0});
  const std::string stop_bytes(stopped.begin(), stopped.end());
  const std::string result = R"("result":)";
  std::vector<Talk> all{
      {"health", Door::http, {}, get("/healthz"), "ok\n"},
      {"metrics", Door::http, {}, get("/metrics"), "tmcl"},
      {"no such page", Door::http, {}, get("/nothing"), "HTTP/1.1 404"},
      {"a call that reads", Door::http, {}, post(state), result},
      {"a second call", Door::http, post(state), post(state), result},
      {"a call that moves", Door::http, {}, post(move), result},
      {"a call that stops", Door::http, post(state), post(stop), result, true},
      {"a WebSocket", Door::http, {}, upgrade, R"("hello")"},
      {"a frame that reads", Door::http, upgrade, frame(state), result},
      {"a frame that moves", Door::http, upgrade, frame(move), result},
      {"a frame that stops", Door::http, upgrade, frame(stop), result, true},
  };
  for (const auto& [door, host] : {std::pair(Door::tcp, "a host"), std::pair(Door::pty, "on a pty"),
                                   std::pair(Door::can, "on CAN")}) {
    const std::string who = host;
    all.push_back({who + " that comes", door, {}, asked, success(Command::GAP)});
    all.push_back({who + " that reads", door, asked, asked, success(Command::GAP)});
    all.push_back({who + " that moves", door, asked, moved, success(Command::MVP)});
    all.push_back({who + " that stops", door, asked, stop_bytes, success(Command::MST), true});
  }
  return all;
}

class FrontSweep {
 public:
  explicit FrontSweep(const Talk& talk) : talk_(talk) {}

  void run() {
    for (std::uint64_t n = 1;; n = after(n)) {
      SCOPED_TRACE(std::string(talk_.name) + ", allocation " + std::to_string(n));
      const bool has_failed = attempt(n);
      if (testing::Test::HasFailure()) return;
      if (!has_failed) break;
      ++failures_;
    }
    EXPECT_GT(failures_, 5);
    std::cout << talk_.name << ": " << failures_ << " allocations failed, the daemon has ended "
              << ends_of_the_daemon_ << " times\n";
  }

 private:
  std::uint64_t after(std::uint64_t n) {
    constexpr std::uint64_t all_until = 60;
    if (n < all_until) return n + 1;
    return n + static_cast<std::uint64_t>(random_.between(1, static_cast<std::int64_t>(n / 5)));
  }

  bool is_http() const { return talk_.door == Door::http; }
  std::uint16_t port() const { return is_http() ? bench_->http_port() : bench_->serial_port(); }
  std::unique_ptr<FrontPeer> new_peer() const {
    if (talk_.door == Door::pty) return std::make_unique<PtyPeer>(bench_->terminal());
    if (talk_.door == Door::can) return std::make_unique<CanPeer>(bench_->can_socket());
    return std::make_unique<TcpPeer>(port());
  }
  /// The host is told nothing of its end, and finds the port open.
  bool is_reopened() const { return talk_.door == Door::pty || talk_.door == Door::can; }
  /// For the port at which the daemon listens.
  std::string addressed(std::string text) const {
    if (const auto at = text.find('$'); at != std::string::npos)
      text.replace(at, 1, std::to_string(port()));
    return text;
  }

  /// Whether there were so many allocations.
  bool attempt(std::uint64_t n) {
    if (!bench_) bench_ = std::make_unique<MemoryBench>();
    MemoryClient other(*bench_);
    if (talk_.stops) turn_z(other);
    auto peer = new_peer();
    if (!talk_.before.empty()) expect_answer(*peer, talk_.before, "");
    peer->say(addressed(talk_.request));
    fail_allocation(n);
    const auto is_answered = [&] { return hears(*peer, talk_.answer); };
    const auto is_over = [&] {
      return is_told(*peer) || peer->is_cut_off() || bench_->has_failed();
    };
    const auto enough = is_reopened() ? tmcl::Duration(3s) : tmcl::Duration(60s);
    bool has_end = bench_->run_until(is_over, enough);
    const bool has_failed = end_failures();
    EXPECT_TRUE(has_failed || is_answered()) << peer->heard();
    if (!has_end && is_reopened()) {
      peer->say(talk_.request);
      has_end = bench_->run_until([&] { return is_answered() || bench_->has_failed(); }, 60s);
    }
    EXPECT_TRUE(has_end) << "neither an answer nor an end: " << peer->heard();
    // What a host at a port has sent was read, whatever failed then.
    if (talk_.stops && (is_told(*peer) || !is_http())) expect_standing();
    if (bench_->has_failed()) ++ends_of_the_daemon_;
    if (bench_->has_failed()) {
      expect_end();
    } else {
      peer.reset();
      expect_service();
    }
    return has_failed;
  }

  static bool hears(FrontPeer& peer, const std::string& text) {
    return peer.heard().find(text) != std::string::npos;
  }
  /// Answered, if only that it failed, or that the WebSocket ends: RFC 6455, 5.5.1.
  bool is_told(FrontPeer& peer) const {
    if (hears(peer, talk_.answer) || hears(peer, R"("error":)")) return true;
    if (talk_.before == upgrade && peer.heard().starts_with('\x88')) return true;
    return !is_http() && peer.heard().size() >= tmcl::serial_datagram_size;
  }
  void expect_standing() {
    EXPECT_TRUE(bench_->run_until([&] { return !bench_->moves(); }, 30s));
  }

  void turn_z(MemoryClient& client) {
    const auto answer = client.call("axis.rotate", R"({"axis":"z","velocity_internal":300})");
    ASSERT_TRUE(answer.contains("result")) << json::serialize(answer);
  }

  void expect_answer(FrontPeer& peer, const std::string& request, const std::string& answer) {
    peer.forget();
    peer.say(addressed(request));
    EXPECT_TRUE(bench_->run_until([&] { return !peer.heard().empty(); }, 60s));
    bench_->run_for(100ms);
    EXPECT_THAT(peer.heard(), HasSubstr(answer));
    peer.forget();
  }

  void expect_end() {
    EXPECT_TRUE(bench_->run_until([&] { return bench_->daemon().has_ended(); }, 500s));
    expect_standing();
    bench_.reset();
  }

  void expect_service() {
    MemoryClient other(*bench_);
    EXPECT_TRUE(other.call("system.stop_all", "{}").contains("result"));
    expect_standing();
    const auto next = new_peer();
    if (!talk_.before.empty()) expect_answer(*next, talk_.before, "");
    expect_answer(*next, talk_.request, talk_.answer);
    EXPECT_TRUE(other.call("system.stop_all", "{}").contains("result"));
    expect_standing();
  }

  const Talk& talk_;
  tmcl::test::Random<> random_{tmcl::test::seed()};
  std::unique_ptr<MemoryBench> bench_;
  int failures_ = 0;
  int ends_of_the_daemon_ = 0;
};

class MemoryOfFront : public testing::TestWithParam<std::size_t> {};

TEST_P(MemoryOfFront, IsMissingAnywhereAndItsClientIsToldOrCutOff) {
  const auto all = talks();
  FrontSweep(all[GetParam()]).run();
}

std::string name_of_talk(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = talks()[info.param].name;
  std::ranges::replace(name, ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, MemoryOfFront, testing::Range(std::size_t{0}, talks().size()),
                         name_of_talk);

}  // namespace
}  // namespace tmcld::test
