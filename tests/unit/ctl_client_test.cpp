// The client's side of a conversation, against a daemon that says what the test wants.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include <boost/json.hpp>

#include "support/temp_path.hpp"
#include "tmcl/client.hpp"

namespace tmcl::client {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr const char* greeting =
    R"({"jsonrpc":"2.0","method":"hello","params":{"protocol":{"major":1,"minor":0},"daemon":"9.9"}})"
    "\n";

/// Accepts one client, says `first`, and then answers each line with what `answer` makes of it.
class FakeDaemon {
 public:
  using Answer = std::function<std::string(const boost::json::object& request)>;

  explicit FakeDaemon(std::string first, Answer answer = {})
      : path_(std::filesystem::temp_directory_path() /
              ("ctl_client_" + std::to_string(::getpid()) + ".sock")),
        listener_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    bind_to(path_, listener_);
    ::listen(listener_, 1);
    thread_ = std::thread(
        [this, first = std::move(first), answer = std::move(answer)] { serve(first, answer); });
  }
  ~FakeDaemon() {
    ending_ = true;
    thread_.join();
    ::close(listener_);
    std::filesystem::remove(path_);
  }
  FakeDaemon(const FakeDaemon&) = delete;
  FakeDaemon& operator=(const FakeDaemon&) = delete;

  const std::string& path() const { return path_; }

  /// What a daemon that was killed leaves behind.
  static void leave_stale_socket(const std::string& path) {
    const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bind_to(path, listener);
    ::close(listener);
  }

 private:
  static void bind_to(const std::string& path, int listener) {
    std::filesystem::remove(path);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    ::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }

  bool readable(int descriptor) const {
    pollfd entry{descriptor, POLLIN, 0};
    while (!ending_) {
      if (::poll(&entry, 1, 10) > 0) return true;
    }
    return false;
  }

  void serve(const std::string& first, const Answer& answer) {
    if (!readable(listener_)) return;
    const int client = ::accept(listener_, nullptr, nullptr);
    ::send(client, first.data(), first.size(), MSG_NOSIGNAL);
    std::string line;
    char byte = 0;
    while (readable(client) && ::recv(client, &byte, 1, 0) == 1) {
      if (byte != '\n') {
        line += byte;
        continue;
      }
      const auto text = answer ? answer(boost::json::parse(line).as_object()) : std::string{};
      line.clear();
      if (text == "hang up") break;
      ::send(client, text.data(), text.size(), MSG_NOSIGNAL);
    }
    ::close(client);
  }

  std::string path_;
  int listener_;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

Options quick() {
  Options options;
  options.hello_timeout = milliseconds(200);
  options.call_timeout = milliseconds(200);
  return options;
}

std::string id_of(const boost::json::object& request) {
  return boost::json::serialize(request.at("id"));
}

TEST(CtlClient, CallsAndReadsTheResult) {
  boost::json::object seen;
  FakeDaemon daemon(greeting, [&](const auto& request) {
    seen = request;
    return R"({"jsonrpc":"2.0","id":)" + id_of(request) + R"(,"result":{"value":7}})" + "\n";
  });
  auto connection = Caller::open(daemon.path()).value();
  EXPECT_EQ(connection.version(), "9.9");
  EXPECT_EQ(connection.call("parameter.get", {{"axis", "x"}}).value().at("value"), 7);
  EXPECT_EQ(seen.at("jsonrpc"), "2.0");
  EXPECT_EQ(seen.at("method"), "parameter.get");
  EXPECT_EQ(seen.at("params").at("axis"), "x");
}

TEST(CtlClient, KeepsAllThatTheDaemonSaysOfAnError) {
  FakeDaemon daemon(greeting, [](const auto& request) {
    return R"({"jsonrpc":"2.0","id":)" + id_of(request) +
           R"(,"error":{"code":-32000,"message":"no","data":{"name":"reply_timeout","outcome":"unknown",)"
           R"("hint":"look","bus":"bench"}}})"
           "\n";
  });
  auto connection = Caller::open(daemon.path()).value();
  const auto error = connection.call("axis.stop").error();
  EXPECT_EQ(error.kind, ErrorKind::failed);
  EXPECT_EQ(error.name, "reply_timeout");
  EXPECT_EQ(error.outcome, Outcome::unknown);
  EXPECT_EQ(error.message, "no");
  EXPECT_EQ(error.hint, "look");
  EXPECT_EQ(error.subject.at("bus"), "bench");
}

TEST(CtlClient, HandsOutWhatComesUnasked) {
  FakeDaemon daemon(greeting, [](const auto& request) {
    return R"({"jsonrpc":"2.0","method":"notify_state","params":{"axis":"x"}})"
           "\n"
           R"({"jsonrpc":"2.0","id":99,"result":{"for":"someone else"}})"
           "\n"
           R"({"jsonrpc":"2.0","id":)" +
           id_of(request) + R"(,"result":{}})" + "\n" +
           R"({"jsonrpc":"2.0","method":"notify_event","params":{}})" + "\n";
  });
  auto connection = Caller::open(daemon.path()).value();
  std::vector<std::string> heard;
  connection.on_notification(
      [&](std::string_view method, const auto&) { heard.emplace_back(method); });
  EXPECT_TRUE(connection.call("subscribe").value().empty());
  EXPECT_THAT(heard, testing::ElementsAre("notify_state"));
  EXPECT_TRUE(connection.listen(milliseconds(500)));
  EXPECT_THAT(heard, testing::ElementsAre("notify_state", "notify_event"));
}

TEST(CtlClient, ProgressGivesACallMoreTime) {
  int reports = 0;
  FakeDaemon daemon(greeting, [&](const auto& request) {
    std::string text =
        R"({"jsonrpc":"2.0","method":"notify_progress","params":{"id":)" + id_of(request) + "}}\n";
    return reports++ == 0 ? text : std::string{};
  });
  auto connection = Caller::open(daemon.path(), quick()).value();
  const auto before = std::chrono::steady_clock::now();
  const auto error = connection.call("bus.scan").error();
  EXPECT_EQ(error.name, error_name::timeout);
  EXPECT_EQ(error.outcome, Outcome::unknown);
  EXPECT_GE(std::chrono::steady_clock::now() - before, milliseconds(200));
}

TEST(CtlClient, ALostConnectionLeavesTheOutcomeUnknown) {
  FakeDaemon daemon(greeting, [](const auto&) { return "hang up"; });
  auto connection = Caller::open(daemon.path()).value();
  const auto error = connection.call("axis.move_to").error();
  EXPECT_EQ(error.name, error_name::lost);
  EXPECT_EQ(error.outcome, Outcome::unknown);
  const auto second = connection.call("axis.move_to");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().name, error_name::lost);
}

TEST(CtlClient, KnowsWhenItIsNoTmcld) {
  for (const auto* first :
       {"SSH-2.0-OpenSSH\n", "{}\n", "[]\n", "",
        R"({"jsonrpc":"2.0","method":"hello","params":{"protocol":{"major":2}}})"
        "\n"}) {
    FakeDaemon daemon(first);
    const auto connection = Caller::open(daemon.path(), quick());
    ASSERT_FALSE(connection) << first;
    EXPECT_EQ(connection.error().name, error_name::incompatible) << first;
    EXPECT_EQ(connection.error().outcome, Outcome::not_sent);
  }
}

TEST(CtlClient, AnEndlessLineIsNotSwallowed) {
  FakeDaemon daemon(greeting,
                    [](const auto&) { return std::string(max_line_bytes + 100'000, 'x'); });
  auto connection = Caller::open(daemon.path()).value();
  EXPECT_EQ(connection.call("axis.list").error().name, error_name::lost);
}

TEST(CtlClient, CanBeCancelled) {
  FakeDaemon daemon(greeting);
  Options options;
  const auto since = std::chrono::steady_clock::now();
  options.cancelled = [&] { return std::chrono::steady_clock::now() - since > milliseconds(150); };
  auto connection = Caller::open(daemon.path(), options).value();
  EXPECT_EQ(connection.call("axis.wait").error().name, error_name::cancelled);
}

TEST(CtlClient, NamesTheSocketThatIsNotThere) {
  const auto error = Caller::open("/nowhere/tmcld.sock").error();
  EXPECT_EQ(error.name, error_name::unreachable);
  EXPECT_EQ(error.outcome, Outcome::not_sent);
  EXPECT_THAT(error.message, HasSubstr("/nowhere/tmcld.sock"));
  EXPECT_THAT(error.hint, HasSubstr("tmcld"));
  EXPECT_EQ(Caller::open(std::string(500, 'x')).error().name, error_name::unreachable);
  EXPECT_EQ(Caller::open("").error().name, error_name::unreachable);
}

/// `event` happens while the client waits for the socket. A test whose client does not wait fails,
/// one whose client waits in vain ends.
Options patient(std::function<void()> event) {
  Options options;
  options.wait_for_socket = std::chrono::seconds(20);
  options.cancelled = [event = std::move(event), turns = 0]() mutable {
    if (++turns == 3) event();
    return false;
  };
  return options;
}

TEST(CtlClient, WaitsForADaemonThatIsStarting) {
  const auto path = FakeDaemon(greeting).path();
  ASSERT_FALSE(std::filesystem::exists(path));
  std::optional<FakeDaemon> daemon;
  EXPECT_TRUE(Caller::open(path, patient([&] { daemon.emplace(greeting); })));
}

TEST(CtlClient, WaitsForADaemonThatReplacesTheSocketOfOneThatWasKilled) {
  const auto path = FakeDaemon(greeting).path();
  FakeDaemon::leave_stale_socket(path);
  std::optional<FakeDaemon> daemon;
  EXPECT_TRUE(Caller::open(path, patient([&] { daemon.emplace(greeting); })));
}

TEST(CtlClient, SaysHowLongItWaited) {
  Options options;
  options.wait_for_socket = milliseconds(60);
  const auto path = FakeDaemon(greeting).path();
  const auto error = Caller::open(path, options).error();
  EXPECT_EQ(error.name, error_name::unreachable);
  EXPECT_THAT(error.message,
              testing::ContainsRegex("No such file or directory \\(waited [0-9.]+ s for it\\)"));
}

TEST(CtlClient, DoesNotWaitForWhatCannotComeRight) {
  const auto no_socket = tmcl::test::temp_path("no_socket");
  std::ofstream(no_socket) << "text";
  for (const auto& path : {std::string("/nowhere/tmcld.sock"), no_socket, std::string("/tmp/"),
                           std::string(500, 'x'), std::string()}) {
    const auto error = Caller::open(path, patient([] {})).error();
    EXPECT_EQ(error.name, error_name::unreachable) << path;
    EXPECT_THAT(error.message, testing::Not(HasSubstr("waited"))) << path;
  }
  std::filesystem::remove(no_socket);
}

TEST(CtlClient, CanBeCancelledWhileItWaits) {
  Options options;
  options.cancelled = [] { return true; };
  const auto error = Caller::open(FakeDaemon(greeting).path(), options).error();
  EXPECT_EQ(error.name, error_name::cancelled);
  EXPECT_EQ(error.outcome, Outcome::not_sent);
}

}  // namespace
}  // namespace tmcl::client
