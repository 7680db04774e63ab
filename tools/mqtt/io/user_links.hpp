/// A connection to tmcld for each user and role that calls come for: tmcld knows the user as the
/// holder of its leases, and its calls go on side by side.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "io/gateway_link.hpp"
#include "protocol/gate.hpp"

namespace tmclmqtt {

class UserLinks : public std::enable_shared_from_this<UserLinks> {
 public:
  static constexpr std::size_t most_links = 32;
  /// Calls that wait for their connection.
  static constexpr std::size_t most_waiting = 16;
  /// No lease lasts longer without being renewed: what is still held then is held by no user.
  static constexpr tmcl::Duration longest_silence = std::chrono::seconds(61);

  /// `gate` outlives it.
  UserLinks(const boost::asio::any_io_executor& executor, std::string socket, const Gate& gate)
      : executor_(executor), socket_(std::move(socket)), gate_(gate) {}

  /// False if there are too many, and no link of this user.
  bool has_room_for(const CallWanted& call);
  void call(CallWanted call, tmcl::TimePoint judged, GatewayLink::OnAnswer on_answer);
  /// Ends the connections of users from whom nothing has come for long.
  void end_silent_ones(tmcl::TimePoint now);
  void close();

 private:
  using Key = std::pair<std::string, tmcld::Role>;
  struct Waiting {
    CallWanted call;
    tmcl::TimePoint judged;
    GatewayLink::OnAnswer on_answer;
  };
  struct UserLink {
    std::shared_ptr<GatewayLink> link{};  ///< Null: it is being opened.
    std::vector<Waiting> waiting{};
    tmcl::TimePoint used{};
  };

  static boost::asio::awaitable<void> open(std::shared_ptr<UserLinks> self, Key key);
  void send(GatewayLink& link, Waiting waiting);
  static void refuse(const GatewayLink::OnAnswer& on_answer, tmcl::client::Error error);

  boost::asio::any_io_executor executor_;
  std::string socket_;
  const Gate& gate_;
  std::map<Key, UserLink> links_;
};

}  // namespace tmclmqtt
