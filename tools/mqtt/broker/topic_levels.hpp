/// The levels of a topic, and what gateways and users may be called in them. Does no I/O.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace tmclmqtt {

/// All topics of docs/FLEET.md begin with it.
constexpr std::string_view topic_root = "tmcl/v1/";
/// In place of a gateway: for all of them.
constexpr std::string_view level_of_all = "all";
/// Of a gateway, of a user, of a method: a level of a topic.
constexpr std::size_t max_level_bytes = 64;

/// 1 to 64 letters, digits, '_', '-', '.', '@': no wildcard, no '/', nothing that a certificate
/// cannot name.
bool is_level(std::string_view text);
/// And none of the words that topics of all gateways begin with.
bool is_gateway_name(std::string_view name);
/// Views into `topic`; empty levels, too.
std::vector<std::string_view> levels_of(std::string_view topic);

}  // namespace tmclmqtt
