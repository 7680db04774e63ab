#include "protocol/outbox.hpp"

#include <utility>

namespace tmclmqtt {

void Outbox::drop_answer() {
  answer_bytes_ -= answers_.front().payload.size();
  answers_.pop_front();
}

void Outbox::add_answer(Publication answer) {
  answer_bytes_ += answer.payload.size();
  answers_.push_back(std::move(answer));
  while (answers_.size() > most_answers ||
         (answer_bytes_ > most_answer_bytes && answers_.size() > 1))
    drop_answer();
}

void Outbox::add_news(Publication news) {
  const auto topic = news.topic;
  const bool is_new = news_.insert_or_assign(topic, std::move(news)).second;
  if (is_new) order_.push_back(topic);
}

std::optional<Publication> Outbox::take() {
  if (!answers_.empty()) {
    auto answer = std::move(answers_.front());
    answer_bytes_ -= answer.payload.size();
    answers_.pop_front();
    return answer;
  }
  if (order_.empty()) return std::nullopt;
  auto found = news_.extract(order_.front());
  order_.pop_front();
  return std::move(found.mapped());
}

void Outbox::clear() { *this = {}; }

}  // namespace tmclmqtt
