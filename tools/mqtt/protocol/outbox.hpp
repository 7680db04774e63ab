/// What waits to be published while the broker takes nothing: of each retained topic, and of each
/// axis' telemetry, the newest; of answers some, the oldest make room. Does no I/O.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "broker/message.hpp"

namespace tmclmqtt {

class Outbox {
 public:
  static constexpr std::size_t most_answers = 256;
  static constexpr std::size_t most_answer_bytes = 4U << 20U;

  /// It goes to its own reader.
  void add_answer(Publication answer);
  /// It takes the place of an older one on the same topic.
  void add_news(Publication news);
  /// Answers first.
  std::optional<Publication> take();
  bool empty() const { return answers_.empty() && news_.empty(); }
  void clear();

 private:
  void drop_answer();

  std::deque<Publication> answers_;
  std::size_t answer_bytes_ = 0;
  std::deque<std::string> order_;  ///< Topics of the news, the one that waits for longest first.
  std::map<std::string, Publication> news_;
};

}  // namespace tmclmqtt
