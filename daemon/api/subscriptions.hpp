/// What one client watches. States are conflated: whatever a client has not read yet is replaced
/// by what is newer, so a slow client costs no memory and never sees old news.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/json/object.hpp>

#include "gateway/axis/poller.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

constexpr std::size_t max_subscriptions = 64;

class Subscriptions {
 public:
  /// `on_pending`: called whenever there is something to take.
  explicit Subscriptions(std::function<void()> on_pending) : on_pending_(std::move(on_pending)) {}

  struct Start {
    std::shared_ptr<GatewayAxis> axis;
    std::optional<PublishedReading> reading;  ///< What the client is told in the answer.
  };
  /// What a client wants to be told.
  struct Wish {
    tmcl::Duration interval{};
    std::vector<std::string> parameters{};  ///< By name or number.
    bool every_look = false;                ///< Also those that change nothing.
    bool all = false;                       ///< Whatever axes the configuration has.
  };

  std::size_t size() const { return subscriptions_.size(); }
  /// The number of the new subscription; numbers count from one and are never used again.
  std::uint64_t add(const std::vector<Start>& axes, const Wish& wish);
  /// False if there is none of that number.
  bool remove(std::uint64_t subscription) { return subscriptions_.erase(subscription) > 0; }
  void clear() { subscriptions_.clear(); }
  /// Another configuration holds: watches the axes that have the names now. What has gone is not
  /// watched any more.
  void follow(Gateway& gateway);

  bool has_pending() const;
  /// The parameters of the next notify_state; takes turns between axes.
  std::optional<boost::json::object> take_pending();

 private:
  struct Item {
    std::shared_ptr<GatewayAxis> axis;
    const Wish* wish = nullptr;  ///< Of its subscription.
    /// Nothing before the first reading: which names there are depends on the model.
    std::optional<std::vector<std::uint8_t>> parameters;
    AxisWatch watch;
    std::optional<PublishedReading> pending;
    std::uint64_t offered_seq = 0;
    std::vector<std::int32_t> offered_values;  ///< Of its parameters.
    tmcl::TimePoint offered_at{};
    std::uint64_t dropped = 0;
  };
  struct Watched {
    Wish wish;
    std::vector<std::unique_ptr<Item>> items{};
  };

  void watch(Item& item, std::shared_ptr<GatewayAxis> axis);
  Item& add_item(Watched& watched, std::shared_ptr<GatewayAxis> axis);
  void follow(Watched& watched, Gateway& gateway);
  static void sample(Item& item);
  static std::vector<std::int32_t> values_of(const Item& item, const PublishedReading& reading);
  void on_reading(Item& item, const PublishedReading& reading, tmcl::TimePoint tick);

  std::function<void()> on_pending_;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, Watched> subscriptions_;
  /// Where the search for the next pending state begins, so that none starves.
  std::size_t turn_ = 0;
};

}  // namespace tmcld
