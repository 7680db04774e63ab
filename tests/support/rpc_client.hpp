/// A client of the daemon with nothing between a test and the socket.
#pragma once

#include <cerrno>
#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <boost/json.hpp>

namespace tmcl::test {

namespace json = boost::json;

/// Whether a descriptor gets ready for these events of poll() in time.
using WaitForSocket = std::function<bool(int descriptor, short events, int wait_ms)>;

inline bool wait_in_real_time(int descriptor, short events, int wait_ms) {
  pollfd waiting{descriptor, events, 0};
  return ::poll(&waiting, 1, wait_ms) > 0;
}

/// Where a daemon is found, and how its clients wait for it: one that runs on their own thread does
/// its work meanwhile.
struct DaemonSocket {
  DaemonSocket(std::string its_path, WaitForSocket its_wait = wait_in_real_time)
      : path(std::move(its_path)), wait(std::move(its_wait)) {}

  std::string path;
  WaitForSocket wait;
};

class RpcClient {
 public:
  static constexpr int patience_ms = 60'000;  // on a busy machine

  /// Reads the greeting as well, unless told not to.
  explicit RpcClient(const DaemonSocket& socket, bool greet = true)
      : descriptor_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)), wait_(socket.wait) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket.path.copy(address.sun_path, sizeof address.sun_path - 1);
    if (::connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("cannot connect to " + socket.path);
    }
    if (greet) greeting_ = read();
  }
  RpcClient(const RpcClient&) = delete;
  RpcClient& operator=(const RpcClient&) = delete;
  ~RpcClient() { hang_up(); }

  void hang_up() {
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  }
  void end_input() { ::shutdown(descriptor_, SHUT_WR); }
  const json::value& greeting() const { return greeting_; }

  bool send_raw(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto sent =
          ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && errno == EAGAIN && wait_(descriptor_, POLLOUT, patience_ms)) continue;
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  /// False instead of waiting for a daemon that does not read.
  bool send_if_room(std::string_view bytes) {
    return ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) > 0;
  }

  /// The next line without its end; nothing if none comes in time or the daemon hangs up.
  std::optional<std::string> read_line(int wait_ms = patience_ms) {
    while (true) {
      const auto end = input_.find('\n');
      if (end != std::string::npos) {
        auto line = input_.substr(0, end);
        input_.erase(0, end + 1);
        return line;
      }
      if (!read_more(wait_ms)) return std::nullopt;
    }
  }
  /// Null if nothing comes.
  json::value read(int wait_ms = patience_ms) {
    const auto line = read_line(wait_ms);
    return line ? json::parse(*line) : json::value();
  }
  bool is_cut_off() {
    while (read_line()) {
    }
    return hung_up_;
  }

  int send(std::string_view method, json::object params = {}) {
    json::object request;
    request["jsonrpc"] = "2.0";
    request["id"] = ++last_id_;
    request["method"] = method;
    request["params"] = std::move(params);
    send_raw(json::serialize(request) + "\n");
    return last_id_;
  }
  /// The answer to a request; notifications that come before it are kept for notification().
  json::object answer_to(int id) {
    for (auto known = others_.begin(); known != others_.end(); ++known) {
      if (!is_answer_to(*known, id)) continue;
      auto message = std::move(*known);
      others_.erase(known);
      return message;
    }
    while (true) {
      auto message = read();
      if (!message.is_object()) throw std::runtime_error("no answer");
      if (is_answer_to(message.get_object(), id)) return message.get_object();
      others_.push_back(message.get_object());
    }
  }
  json::object call(std::string_view method, json::object params = {}) {
    return answer_to(send(method, std::move(params)));
  }
  /// The result; throws if it is an error.
  json::object result(std::string_view method, json::object params = {}) {
    auto answer = call(method, std::move(params));
    if (!answer.contains("result")) throw std::runtime_error(json::serialize(answer));
    return answer.at("result").as_object();
  }
  /// "code" and "data" of the error; throws if it is a result.
  json::object error(std::string_view method, json::object params = {}) {
    auto answer = call(method, std::move(params));
    if (!answer.contains("error")) throw std::runtime_error(json::serialize(answer));
    return answer.at("error").as_object();
  }
  /// The parameters of the next notification of this kind; null if none comes in time.
  json::value notification(std::string_view method, int wait_ms = patience_ms) {
    for (auto known = others_.begin(); known != others_.end(); ++known) {
      if (!is_notification(*known, method)) continue;
      auto params = known->at("params");
      others_.erase(known);
      return params;
    }
    while (true) {
      auto message = read(wait_ms);
      if (!message.is_object()) return nullptr;
      if (is_notification(message.get_object(), method)) return message.at("params");
      others_.push_back(message.get_object());
    }
  }

 private:
  static bool is_answer_to(const json::object& message, int id) {
    const auto* found = message.if_contains("id");
    return found != nullptr && found->is_int64() && found->get_int64() == id;
  }
  static bool is_notification(const json::object& message, std::string_view method) {
    const auto* found = message.if_contains("method");
    return found != nullptr && found->as_string() == json::string_view(method);
  }

  bool read_more(int wait_ms) {
    if (!wait_(descriptor_, POLLIN, wait_ms)) return false;
    char buffer[65536];
    const auto count = ::read(descriptor_, buffer, sizeof buffer);
    if (count <= 0) hung_up_ = true;
    if (count <= 0) return false;
    input_.append(buffer, static_cast<std::size_t>(count));
    return true;
  }

  int descriptor_;
  WaitForSocket wait_;
  std::string input_;
  std::deque<json::object> others_;
  json::value greeting_;
  int last_id_ = 0;
  bool hung_up_ = false;
};

}  // namespace tmcl::test
