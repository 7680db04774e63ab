#include "protocol/topics.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace tmclmqtt {
namespace {

constexpr std::string_view root = "tmcl/v1/";
constexpr std::string_view reply_root = "tmcl/v1/reply/";
// Topics of all gateways begin with them.
constexpr std::array<std::string_view, 2> words_of_all{"all", "reply"};

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

std::optional<Topic> call_topic(std::string_view role, std::string_view user,
                                std::string_view method) {
  const auto known = std::ranges::find(tmcld::role_names, role);
  if (known == tmcld::role_names.end() || !is_level(user) || !is_level(method)) return std::nullopt;
  const auto number = known - tmcld::role_names.begin();
  return CallTopic{static_cast<Role>(number), std::string(user), std::string(method)};
}

}  // namespace

bool is_gateway_name(std::string_view name) {
  return is_level(name) && std::ranges::count(words_of_all, name) == 0;
}

Topics::Topics(std::string_view gateway)
    : gateway_(gateway), own_(std::string(root) + gateway_ + '/') {}

std::string Topics::stop_of_all() { return std::string(root) + "all/stop"; }

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
  const bool is_for_all = !user && levels[1] == words_of_all[0];
  if (levels[1] != gateway_ && !is_for_all) return std::nullopt;
  auto topic = std::string(reply_root) + std::string(levels[0]) + '/' + gateway_;
  for (std::size_t i = 2; i < levels.size(); ++i) topic += '/' + std::string(levels[i]);
  return topic;
}

}  // namespace tmclmqtt
