/// The answers that wait to be written to one client: bounded, whatever the client does.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace tmcld {

constexpr std::size_t max_unsent_answer_bytes = 256U * 1024U;
/// As many as requests, stops and renewals can be in progress: what was let through can be
/// answered, however long the answers are.
constexpr std::size_t max_unsent_answers = 192;

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

  std::optional<std::string> take_answer() {
    if (answers_.empty()) return std::nullopt;
    auto line = std::move(answers_.front());
    answers_.pop_front();
    answer_bytes_ -= line.size() + 1;
    return line;
  }

  bool empty() const { return answers_.empty(); }

 private:
  std::deque<std::string> answers_;
  std::size_t answer_bytes_ = 0;
};

}  // namespace tmcld
