/// A gateway as an edge node of Sparkplug B 3.0, and each of its axes as a device of that. A
/// message is made when the broker takes one, from what is known then: nothing waits, no sequence
/// number is left out, and what has changed twice meanwhile is told once. The one command that it
/// takes is a rebirth. Does no I/O, reads no clock.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json/object.hpp>

#include "broker/message.hpp"
#include "protocol/listed_axis.hpp"
#include "protocol/sparkplug_payload.hpp"
#include "tmcl/clock.hpp"

namespace tmclmqtt {

/// Levels of its topics; see is_level().
struct SparkplugNames {
  std::string group;
  std::string node;
  std::string host{};  ///< Births wait until this one is online; empty: for none.
};

class Sparkplug {
 public:
  /// Least time between two messages that tell only where an axis is and how fast.
  static constexpr tmcl::Duration data_interval = std::chrono::milliseconds(500);
  /// Least time between two births of the node on a connection, however often hosts ask.
  static constexpr tmcl::Duration birth_interval = std::chrono::seconds(1);

  /// `version`: of this program.
  Sparkplug(SparkplugNames names, std::string_view version);

  /// What a connection subscribes to, with QoS 1.
  std::vector<std::string> filters() const;
  /// A connection is about to be made: its will.
  Publication begin(tmcl::UtcTime utc);
  /// The broker has let it in.
  void connected() { is_connected_ = true; }
  /// It has ended.
  void end();

  /// A state as tmcld tells it.
  void hear(const boost::json::object& told);
  /// tmcld is there, in that version, with these axes.
  void know(const std::string& daemon, const std::vector<ListedAxis>& axes);
  /// tmcld has gone.
  void forget() { know({}, {}); }
  void take(const Message& message);

  /// What is to be published now, until there is nothing more; to be asked a few times a second.
  std::optional<Publication> next(tmcl::TimePoint now, tmcl::UtcTime utc);
  /// The host has gone for which births wait: say farewell, and connect anew.
  bool is_over() const { return is_born_ && !has_host(); }
  /// Before the connection ends as asked; nothing if there was no birth.
  std::optional<Publication> farewell(tmcl::UtcTime utc) const;

 private:
  struct Told {
    boost::json::object metrics{};
    std::string unit{};
    tmcl::TimePoint at{};
  };
  struct Device {
    bool is_listed = false;
    bool answers = false;
    std::string unit{};
    boost::json::object metrics{};  ///< Values by name; empty: not known yet.
    std::optional<Told> told{};     ///< What hosts know of it; none: not that it is there.

    bool is_there() const { return is_listed && answers && !metrics.empty(); }
  };

  bool has_host() const { return names_.host.empty() || host_is_online_; }
  std::string topic(std::string_view verb, const std::string& device = {}) const;
  Publication said(std::string_view verb, const std::string& device, std::vector<Metric> metrics,
                   tmcl::UtcTime utc);
  Publication death(tmcl::UtcTime utc) const;
  void take_state(const Message& message);
  void forget_told();
  void drop_unknown();

  std::optional<Publication> next_death(tmcl::UtcTime utc);
  std::optional<Publication> next_birth(tmcl::TimePoint now, tmcl::UtcTime utc);
  std::optional<Publication> next_data(tmcl::TimePoint now, tmcl::UtcTime utc);
  Publication birth_of_node(tmcl::TimePoint now, tmcl::UtcTime utc);
  static std::vector<Metric> take_changes(Device& device, tmcl::TimePoint now);
  Metric daemon_metric() const;

  SparkplugNames names_;
  std::string version_;
  std::string daemon_;  ///< Version of tmcld; empty: it is not there.
  std::string daemon_told_;
  std::map<std::string, Device> devices_;
  std::optional<std::uint8_t> birth_number_;  ///< Of the connection: bdSeq.
  std::uint8_t sequence_ = 0;                 ///< Of the next message.
  bool is_connected_ = false;
  bool is_born_ = false;
  bool rebirth_wanted_ = false;
  std::optional<tmcl::TimePoint> born_{};
  bool host_is_online_ = false;
  std::optional<std::int64_t> host_time_;  ///< Of the newest state of the host, by its own clock.
};

}  // namespace tmclmqtt
