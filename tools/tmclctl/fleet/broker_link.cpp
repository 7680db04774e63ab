#include <utility>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>

#include "async/spawn.hpp"
#include "async/workers.hpp"
#include "broker/broker.hpp"
#include "broker/random_text.hpp"
#include "fleet/fleet_link.hpp"

namespace tmclctl {
namespace {

using boost::asio::awaitable;

// How soon a signal is noticed.
constexpr auto turn = std::chrono::milliseconds(20);
constexpr tmcl::Duration connecting_takes_at_most = std::chrono::seconds(10);
// An answer of tmcld has 1 MB at most.
constexpr std::uint32_t max_packet_bytes = 1'200'000;

class BrokerLink final : public FleetLink {
 public:
  BrokerLink(BrokerPlace place, Host& host)
      : place_(std::move(place)), host_(host), id_("tmclctl-" + tmclmqtt::random_text()) {}
  ~BrokerLink() override {
    if (broker_) broker_->disconnect();
    context_.poll();
  }

  Result<void> open(const FleetPlace& typed) {
    auto options = options_of(typed);
    tmcld::spawn(context_.get_executor(), connect(std::move(options)));
    const auto deadline = host_.now() + connecting_takes_at_most;
    while (!answered_ && host_.now() < deadline && host_.signal() == 0) context_.run_for(turn);
    if (broker_) return {};
    if (host_.signal() != 0)
      return tl::unexpected(
          interrupted_error(host_.signal(), "no connection to the broker yet", ""));
    return tl::unexpected(
        Error{"broker_unreachable", ErrorKind::failed, tmcl::Outcome::not_sent,
              fmt::format("broker {}:{}: {}", place_.host, place_.port,
                          why_.empty() ? "no answer" : why_),
              "is the address right, and do --ca, --cert, --key and --password-file fit?"});
  }

  const std::string& user() const override { return place_.user; }
  const std::string& id() const override { return id_; }
  void subscribe(const std::string& filter) override {
    if (broker_) broker_->subscribe({.filter = filter, .qos = 0, .own = true});
  }
  void publish(const tmclmqtt::Publication& publication) override {
    if (broker_) broker_->publish(publication);
  }
  void on_message(OnMessage on_message) override { on_message_ = std::move(on_message); }

  Result<void> listen(tmcl::Duration at_most) override {
    const auto until = host_.now() + at_most;
    came_ = false;
    do {
      context_.restart();
      context_.run_one_for(std::min<tmcl::Duration>(turn, at_most));
      context_.poll();
    } while (!came_ && !is_lost_ && host_.now() < until && host_.signal() == 0);
    if (!is_lost_) return {};
    return tl::unexpected(Error{"broker_lost", ErrorKind::failed, tmcl::Outcome::unknown,
                                "the connection to the broker has ended: " + why_,
                                "gateways go on by themselves; a stop can be sent on each"});
  }

 private:
  tmclmqtt::BrokerOptions options_of(const FleetPlace& typed) const {
    tmclmqtt::BrokerOptions options;
    options.host = place_.host;
    options.port = place_.port;
    options.client_id = id_;
    options.trusts_system = place_.tls && typed.ca_file.empty();
    options.ca = typed.ca_file;
    options.certificate = typed.certificate_file;
    options.key = typed.key_file;
    if (place_.says_user) options.user = place_.user;
    // It may have come from a pipe, which is read once.
    options.password = [password = place_.password] { return password; };
    options.max_packet_bytes = max_packet_bytes;
    return options;
  }

  awaitable<void> connect(tmclmqtt::BrokerOptions options) {
    const auto on_message = [this](const tmclmqtt::Message& message) {
      came_ = true;
      if (on_message_) on_message_(message);
    };
    auto connecting = tmclmqtt::connect_to_broker(workers_, std::move(options), on_message, [] {});
    auto connected = co_await std::move(connecting);
    answered_ = true;
    if (!connected) {
      why_ = connected.error();
      co_return;
    }
    broker_ = *connected;
    why_ = co_await broker_->end();
    is_lost_ = true;
  }

  BrokerPlace place_;
  Host& host_;
  std::string id_;
  boost::asio::io_context context_{1};
  tmcld::Workers workers_{1};
  std::shared_ptr<tmclmqtt::Broker> broker_;
  OnMessage on_message_;
  bool answered_ = false;
  bool came_ = false;
  bool is_lost_ = false;
  std::string why_;
};

}  // namespace

Result<std::unique_ptr<FleetLink>> open_fleet(const FleetPlace& place, Host& host) {
  auto broker = find_broker(place);
  if (!broker) return tl::unexpected(std::move(broker.error()));
  auto link = std::make_unique<BrokerLink>(std::move(*broker), host);
  if (auto opened = link->open(place); !opened) return tl::unexpected(std::move(opened.error()));
  return link;
}

}  // namespace tmclctl
