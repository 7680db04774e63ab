/// The topics of a gateway on a broker, in docs/FLEET.md's words. Does no I/O.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "broker/topic_levels.hpp"
#include "config/config.hpp"

namespace tmclmqtt {

using tmcld::Role;

/// Of a topic that answers go to.
constexpr std::size_t max_reply_topic_bytes = 256;

struct CallTopic {
  Role role = Role::stop;
  std::string user;
  std::string method;

  bool operator==(const CallTopic&) const = default;
};
struct StopTopic {
  bool of_all = false;  ///< For every gateway, not this one alone.

  bool operator==(const StopTopic&) const = default;
};
struct WishTopic {
  std::string user;

  bool operator==(const WishTopic&) const = default;
};
struct BirthTopic {
  bool operator==(const BirthTopic&) const = default;
};
using Topic = std::variant<CallTopic, StopTopic, WishTopic, BirthTopic>;

class Topics {
 public:
  /// `gateway`: a name, see is_gateway_name().
  explicit Topics(std::string_view gateway);

  std::string birth() const { return own_ + "birth"; }
  std::string state(std::string_view axis) const { return own_ + "state/" + std::string(axis); }
  std::string telemetry(std::string_view axis) const {
    return own_ + "telemetry/" + std::string(axis);
  }
  std::string stop() const { return own_ + "stop"; }
  static std::string stop_of_all();
  // What is subscribed to.
  std::string all_calls() const { return own_ + "call/+/+/+"; }
  std::string all_wishes() const { return own_ + "want/+"; }

  /// Nothing if it is none that this gateway takes.
  std::optional<Topic> read(std::string_view topic) const;
  /// Where an answer goes for which a client has named `response_topic`, reply/USER/GATEWAY/...,
  /// without wildcards; nothing if it may not go there. So no answer takes the place of a birth, of
  /// another user's answer or of another gateway's. Where no `user` is known, of stops, USER may be
  /// any, and GATEWAY `all`: each gateway puts its own name there.
  std::optional<std::string> reply(std::string_view response_topic,
                                   const std::optional<std::string>& user) const;

 private:
  std::string gateway_;
  std::string own_;  ///< What those of this gateway begin with.
};

}  // namespace tmclmqtt
