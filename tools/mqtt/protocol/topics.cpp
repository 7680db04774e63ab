#include "protocol/topics.hpp"

#include <algorithm>

namespace tmclmqtt {
namespace {

std::optional<Topic> call_topic(std::string_view role, std::string_view user,
                                std::string_view method) {
  const auto known = std::ranges::find(tmcld::role_names, role);
  if (known == tmcld::role_names.end() || !is_level(user) || !is_level(method)) return std::nullopt;
  const auto number = known - tmcld::role_names.begin();
  return CallTopic{static_cast<Role>(number), std::string(user), std::string(method)};
}

}  // namespace

Topics::Topics(std::string_view gateway)
    : gateway_(gateway), own_(std::string(topic_root) + gateway_ + '/') {}

std::string Topics::stop_of_all() { return std::string(topic_root) + "all/stop"; }

std::optional<Topic> Topics::read(std::string_view topic) const {
  if (topic == stop_of_all()) return StopTopic{true};
  if (!topic.starts_with(own_)) return std::nullopt;
  const auto levels = levels_of(topic.substr(own_.size()));
  if (levels.size() == 1 && levels[0] == "stop") return StopTopic{};
  if (levels.size() == 1 && levels[0] == "birth") return BirthTopic{};
  if (levels.size() == 2 && levels[0] == "want" && is_level(levels[1]))
    return WishTopic{std::string(levels[1])};
  if (levels.size() == 4 && levels[0] == "call") return call_topic(levels[1], levels[2], levels[3]);
  return std::nullopt;
}

std::optional<std::string> Topics::reply(std::string_view response_topic,
                                         const std::optional<std::string>& user) const {
  if (response_topic.size() > max_reply_topic_bytes || !response_topic.starts_with(reply_root))
    return std::nullopt;
  const auto levels = levels_of(response_topic.substr(reply_root.size()));
  if (levels.size() < 3 || !std::ranges::all_of(levels, is_level)) return std::nullopt;
  if (user && levels[0] != *user) return std::nullopt;
  const bool is_for_all = !user && levels[1] == level_of_all;
  if (levels[1] != gateway_ && !is_for_all) return std::nullopt;
  auto topic = std::string(reply_root) + std::string(levels[0]) + '/' + gateway_;
  for (std::size_t i = 2; i < levels.size(); ++i) topic += '/' + std::string(levels[i]);
  return topic;
}

}  // namespace tmclmqtt
