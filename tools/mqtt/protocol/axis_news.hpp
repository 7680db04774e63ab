/// What is told of axes: states that are retained, when something about one has changed, and how
/// one moves, twice a second at most and only while a user wants it. Does no I/O, reads no clock.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json/object.hpp>

#include "broker/message.hpp"
#include "protocol/topics.hpp"
#include "tmcl/clock.hpp"

namespace tmclmqtt {

class AxisNews {
 public:
  static constexpr tmcl::Duration telemetry_interval = std::chrono::milliseconds(500);
  /// The broker drops a state that was not told again within that time.
  static constexpr std::chrono::seconds state_expiry{3600};
  static constexpr std::size_t most_wishes = 64;

  explicit AxisNews(Topics topics) : topics_(std::move(topics)) {}

  /// Zero: it wants nothing any more.
  void wish(const std::string& user, tmcl::Duration time, tmcl::TimePoint now);
  bool is_wanted(tmcl::TimePoint now) const;
  /// A state as tmcld tells it.
  std::vector<Publication> hear(const boost::json::object& told, tmcl::TimePoint now);
  /// What has become due: to be asked a few times a second.
  std::vector<Publication> due(tmcl::TimePoint now);
  /// Every state that is known: for a broker that may have none.
  std::vector<Publication> all_states(tmcl::TimePoint now);
  /// tmcld has gone, or has other axes.
  void forget_axes() { axes_.clear(); }
  /// The others are not there any more: their states are taken off the broker.
  std::vector<Publication> keep_only(const std::vector<std::string>& axes);

 private:
  struct AxisTold {
    boost::json::object state{};
    bool is_untold_telemetry = false;
    std::optional<tmcl::TimePoint> telemetry_told{};
    tmcl::TimePoint state_told{};
  };

  Publication state_of(const std::string& axis, AxisTold& told, tmcl::TimePoint now) const;
  void add_telemetry(const std::string& axis, AxisTold& told, tmcl::TimePoint now,
                     std::vector<Publication>& into) const;

  Topics topics_;
  std::map<std::string, AxisTold> axes_;
  std::map<std::string, tmcl::TimePoint> wishes_;  ///< Until when, by user.
};

}  // namespace tmclmqtt
