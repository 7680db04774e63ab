#include "broker/topic_levels.hpp"

namespace tmclmqtt {

std::string reply_topic(std::string_view user, std::string_view gateway, std::string_view id) {
  std::string topic(reply_root);
  topic.append(user).append("/").append(gateway).append("/").append(id);
  return topic;
}

bool is_level(std::string_view text) {
  constexpr std::string_view known =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.@";
  return !text.empty() && text.size() <= max_level_bytes &&
         text.find_first_not_of(known) == text.npos;
}

std::vector<std::string_view> levels_of(std::string_view topic) {
  std::vector<std::string_view> levels;
  while (true) {
    const auto end = topic.find('/');
    levels.push_back(topic.substr(0, end));
    if (end == topic.npos) return levels;
    topic.remove_prefix(end + 1);
  }
}

bool is_gateway_name(std::string_view name) {
  return is_level(name) && name != level_of_all && name != "reply";
}

}  // namespace tmclmqtt
