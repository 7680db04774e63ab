/// What waits to be written to one client: bounded, whatever the client does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include <boost/json/object.hpp>

namespace tmcld {

constexpr std::size_t max_unsent_answer_bytes = 256U * 1024U;
/// As many as requests and stops can be in progress: what was let through can be answered, however
/// long the answers are.
constexpr std::size_t max_unsent_answers = 128;
constexpr std::size_t max_unsent_notifications = 64;

class Outbox {
 public:
  /// False if the client has left too many answers unread; it must then be cut off, because an
  /// answer is never dropped.
  bool push_answer(std::string line) {
    answer_bytes_ += line.size() + 1;
    answers_.push_back(std::move(line));
    return answer_bytes_ <= max_unsent_answer_bytes || answers_.size() <= max_unsent_answers;
  }
  std::size_t answer_bytes() const { return answer_bytes_; }

  /// The oldest gives way to the newest; the next one that is written says how many did.
  void push_notification(std::string method, boost::json::object params) {
    if (notifications_.size() >= max_unsent_notifications) {
      notifications_.pop_front();
      ++dropped_;
    }
    notifications_.emplace_back(std::move(method), std::move(params));
  }

  struct Notification {
    std::string method;
    boost::json::object params;
  };

  std::optional<std::string> take_answer() {
    if (answers_.empty()) return std::nullopt;
    auto line = std::move(answers_.front());
    answers_.pop_front();
    answer_bytes_ -= line.size() + 1;
    return line;
  }

  std::optional<Notification> take_notification() {
    if (notifications_.empty()) return std::nullopt;
    Notification oldest{std::move(notifications_.front().first),
                        std::move(notifications_.front().second)};
    notifications_.pop_front();
    oldest.params["dropped"] = std::exchange(dropped_, 0);
    return oldest;
  }

  bool empty() const { return answers_.empty() && notifications_.empty(); }

 private:
  std::deque<std::string> answers_;
  std::size_t answer_bytes_ = 0;
  std::deque<std::pair<std::string, boost::json::object>> notifications_;
  std::uint64_t dropped_ = 0;
};

}  // namespace tmcld
