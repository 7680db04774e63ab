/// The levels of a topic, and what gateways and users may be called in them. Does no I/O.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tmclmqtt {

/// All topics of docs/FLEET.md begin with it.
constexpr std::string_view topic_root = "tmcl/v1/";
/// In place of a gateway: for all of them.
constexpr std::string_view level_of_all = "all";
/// In place of a level, in what is subscribed to.
constexpr std::string_view any_level = "+";
/// Answers to the users are below it.
constexpr std::string_view reply_root = "tmcl/v1/reply/";
/// Of a gateway, of a user, of a method: a level of a topic.
constexpr std::size_t max_level_bytes = 64;

/// Where the answers go that `gateway` gives a process of `user`, `id`; all three are levels.
/// `gateway` is level_of_all in what all gateways are asked, any_level in what is subscribed to.
std::string reply_topic(std::string_view user, std::string_view gateway, std::string_view id);

/// 1 to 64 letters, digits, '_', '-', '.', '@': no wildcard, no '/', nothing that a certificate
/// cannot name.
bool is_level(std::string_view text);
/// And none of the words that topics of all gateways begin with.
bool is_gateway_name(std::string_view name);
/// Views into `topic`; empty levels, too.
std::vector<std::string_view> levels_of(std::string_view topic);

}  // namespace tmclmqtt
