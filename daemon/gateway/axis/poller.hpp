/// Reads an axis at regular times for everyone who watches it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"
#include "gateway/axis/axis.hpp"
#include "gateway/event.hpp"

namespace tmcld {

constexpr tmcl::Duration shortest_poll_interval = std::chrono::milliseconds(5);
/// While axes of the same bus are on a path.
constexpr tmcl::Duration shortest_poll_interval_beside_path = std::chrono::milliseconds(100);
constexpr tmcl::Duration longest_poll_interval = std::chrono::milliseconds(60000);

/// What tmcld knows of an axis, beside what its module tells.
struct AxisStanding {
  explicit AxisStanding(const GatewayAxis& axis);
  bool operator==(const AxisStanding&) const = default;

  bool is_latched = false;
  bool is_referenced = false;
  std::optional<StopCause> stop_cause;
  std::uint64_t last_stop = 0;
  std::int32_t lease = 0;  ///< 0: there is none.
  bool is_unattended = false;
  std::string owner;  ///< Empty: there is none.
  std::vector<UnrestoredSetting> unrestored;
  Faults faults;
};

/// A look that those who watch are told of.
struct PublishedReading {
  AxisReading reading;
  AxisStanding standing;
  /// Of the axis: grows by one whenever something in `reading` or `standing` changed.
  std::uint64_t seq = 0;
  /// What watchers have sampled, as it was read last; without what was not read yet.
  std::vector<ParameterSample> samples{};
};

/// Told of every look, whether anything changed or not. `tick`: when the look was due; ticks are
/// whole intervals apart.
using OnReading = std::function<void(const PublishedReading& reading, tmcl::TimePoint tick)>;

/// Someone's wish to be told; destroying it ends that.
class AxisWatch {
 public:
  AxisWatch() = default;
  AxisWatch(std::shared_ptr<AxisPoller> poller, std::uint64_t id)
      : poller_(std::move(poller)), id_(id) {}
  AxisWatch(AxisWatch&& other) noexcept = default;
  AxisWatch& operator=(AxisWatch&& other) noexcept {
    std::swap(poller_, other.poller_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~AxisWatch();
  /// From now on these parameters are read, too.
  void sample(std::vector<std::uint8_t> parameters);

 private:
  std::shared_ptr<AxisPoller> poller_;
  std::uint64_t id_ = 0;
};

/// One for each axis, however many watch: the shortest interval asked for wins. Reads
/// nothing without a watcher. A look that takes longer than the interval costs ticks, and never
/// piles up.
///
/// Parameters that are sampled are read before a look, one after the other, for as long as half of
/// the interval lasts, at least one; beside a path it is one. The others come before the next look.
/// None is read more than twice in the interval of those who want it, however often others look.
class AxisPoller : public std::enable_shared_from_this<AxisPoller> {
 public:
  explicit AxisPoller(const boost::asio::any_io_executor& executor)
      : executor_(executor), clock_(executor), changed_(executor) {}

  AxisWatch watch(std::shared_ptr<GatewayAxis> axis, tmcl::Duration interval, OnReading on_reading);
  /// Numbers a look that was taken for someone who begins to watch, with what was read beside it.
  PublishedReading number(const GatewayAxis& axis, const AxisReading& reading,
                          const std::vector<ParameterSample>& samples = {});
  /// Numbers go on behind those of the axis that had the name before.
  void count_on_from(const AxisPoller& before) { last_seq_ = before.last_seq_ + 1; }

 private:
  friend class AxisWatch;
  struct Watcher {
    tmcl::Duration interval;
    OnReading on_reading;
    std::vector<std::uint8_t> parameters{};
  };

  void remove(std::uint64_t id);
  tmcl::Duration interval(const GatewayAxis& axis) const;
  void tell(const PublishedReading& reading, tmcl::TimePoint tick);
  /// Of all watchers, with the shortest interval of those that name it.
  std::map<std::uint8_t, tmcl::Duration> parameters() const;
  bool is_due(std::uint8_t parameter, tmcl::Duration interval) const;
  void keep(const ParameterSample& sample);
  boost::asio::awaitable<void> sample(GatewayAxis& axis, tmcl::Duration interval);
  static boost::asio::awaitable<void> run(std::shared_ptr<AxisPoller> self,
                                          std::shared_ptr<GatewayAxis> axis);

  boost::asio::any_io_executor executor_;
  tmcl::ContextClock clock_;
  Wake changed_;
  bool running_ = false;
  std::uint64_t last_seq_ = 0;
  std::optional<PublishedReading> last_;
  std::vector<ParameterSample> samples_;
  std::size_t turn_ = 0;  ///< Which of the parameters is read next.
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, Watcher> watchers_;
};

}  // namespace tmcld
