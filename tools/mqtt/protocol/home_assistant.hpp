/// What Home Assistant is told by its MQTT discovery: a device with sensors for each axis, which
/// read the topics of states, and a button that stops all axes. Retained. Does no I/O, reads no
/// clock.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json/object.hpp>

#include "broker/message.hpp"
#include "protocol/listed_axis.hpp"
#include "protocol/topics.hpp"
#include "tmcl/clock.hpp"

namespace tmclmqtt {

/// 1 to 64 letters, digits, '_', '-': what Home Assistant takes in its topics.
bool is_home_assistant_id(std::string_view name);

class HomeAssistant {
 public:
  /// Home Assistant starts for all gateways at once: within that time each tells it again.
  static constexpr tmcl::Duration longest_delay = std::chrono::seconds(5);
  /// What stands there in place of its own is replaced so often at most.
  static constexpr tmcl::Duration least_interval = std::chrono::seconds(1);
  /// Components of axes that are gone.
  static constexpr std::size_t most_removed = 256;

  /// `gateway`: see is_home_assistant_id(); `prefix`: of its topics; `version`: of this program.
  HomeAssistant(const std::string& gateway, const std::string& prefix, std::string_view version);

  /// What a connection subscribes to.
  std::vector<std::string> filters() const { return {config_, status_}; }
  /// A connection begins, on a broker that may know nothing.
  void begin(tmcl::TimePoint now) { due_ = now; }
  /// tmcld is there with these axes.
  void know(const std::vector<ListedAxis>& axes, tmcl::TimePoint now);
  void take(const Message& message, tmcl::TimePoint now);
  /// To be asked a few times a second.
  std::optional<Publication> due(tmcl::TimePoint now);

 private:
  /// What an earlier run, or another configuration, has left on the broker.
  void see_config(const Message& message, tmcl::TimePoint now);
  void remove(const std::string& component, std::string_view platform);
  boost::json::object components_of(const ListedAxis& axis) const;
  boost::json::object sensor(const ListedAxis& axis, std::string_view what,
                             std::string_view name) const;
  boost::json::object stop_button() const;

  std::string gateway_;
  Topics topics_;
  std::string version_;
  std::string config_;
  std::string status_;
  bool is_known_ = false;
  boost::json::object components_{};              ///< Those that are there.
  std::map<std::string, std::string> removed_{};  ///< Platforms of those that are not any more.
  std::optional<tmcl::TimePoint> due_{};
  tmcl::TimePoint told_{};
};

}  // namespace tmclmqtt
