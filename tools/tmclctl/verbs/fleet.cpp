// fleet gateways, fleet top.
#include <fmt/format.h>

#include "broker/topic_levels.hpp"
#include "fleet/fleet_picture.hpp"
#include "fleet/fleet_verbs.hpp"
#include "output/full_screen.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

constexpr std::uint32_t wish_lasts_s = 60;
constexpr tmcl::Duration wish_interval = std::chrono::seconds(20);

/// A fleet on the screen, until q is pressed.
class FleetTop {
 public:
  FleetTop(const verb::FleetTop& verb, FullScreen& screen, Fleet& fleet)
      : verb_(verb), screen_(screen), fleet_(fleet), picture_(fleet.gateways) {}
  FleetTop(const FleetTop&) = delete;
  FleetTop& operator=(const FleetTop&) = delete;
  ~FleetTop() {
    fleet_.on_message = {};
    wish(0);
  }

  Result<ExitCode> run() {
    fleet_.on_message = [this](const tmclmqtt::Message& message) { picture_.hear(message); };
    for (const auto& filter : picture_.filters()) fleet_.link.subscribe(filter);
    while (go_on()) {
      if (auto heard = fleet_.listen(verb_.interval); !heard)
        return heard.error().kind == ErrorKind::interrupted
                   ? Result<ExitCode>(ExitCode::done)
                   : tl::unexpected(std::move(heard.error()));
    }
    return ExitCode::done;
  }

 private:
  /// Telemetry of each gateway for so long; 0: no more.
  void wish(std::uint32_t seconds) {
    for (const auto& [name, gateway] : fleet_.gateways.all()) {
      if (!gateway.online) continue;
      tmclmqtt::Publication wish;
      wish.topic = fmt::format("{}{}/want/{}", tmclmqtt::topic_root, name, fleet_.link.user());
      wish.retained = true;
      if (seconds > 0) {
        wish.payload = "{}";
        wish.expiry_s = seconds;
      }
      fleet_.link.publish(wish);
    }
  }

  bool go_on() {
    for (auto key = screen_.take_key(); key; key = screen_.take_key()) {
      if (key->letter == 'q') return false;
      if (key->letter == 'a') shows_axes_ = !shows_axes_;
    }
    const auto now = fleet_.host.now();
    if (!wished_ || now - *wished_ >= wish_interval) {
      wished_ = now;
      wish(wish_lasts_s);
    }
    if (now - drawn_ >= verb_.interval) {
      drawn_ = now;
      screen_.show(picture_.lines(screen_.width(), shows_axes_, verb_.internal));
    }
    return true;
  }

  const verb::FleetTop& verb_;
  FullScreen& screen_;
  Fleet& fleet_;
  FleetPicture picture_;
  bool shows_axes_ = verb_.axes;
  std::optional<tmcl::TimePoint> wished_{};
  tmcl::TimePoint drawn_{};
};

Result<ExitCode> show_top(const verb::FleetTop& verb, Fleet& fleet) {
  if (const auto found = FullScreen::look_for(fleet.output.out_screen); !found)
    return tl::unexpected(found.error());
  if (auto found = fleet.find(); !found) return tl::unexpected(found.error());
  const auto screen = FullScreen::open(fleet.output.out_screen);
  if (!screen) return tl::unexpected(screen.error());
  FleetTop top(verb, **screen, fleet);
  return top.run();
}

constexpr const char* fleet_help = R"(
Gateways that tmcld-mqtt has put on an MQTT 5 broker, in one place. --fleet names the broker, --gateways the
gateways that are meant: 'axes', 'state', 'stop' and 'call' work so as well.

  tmclctl --fleet mqtts://broker.example --ca ca.crt --cert anna.crt --key anna.key fleet gateways
)";

constexpr const char* gateways_help = R"(
Whether each is on the broker, whether its tmcld is there, and its axes.

  tmclctl --fleet mqtts://broker.example --cert anna.crt --key anna.key -g 'hall3-*' fleet gateways
)";

constexpr const char* top_help = R"(
One line for each gateway: how many axes move, and what is wrong with which. Gateways that are away stand
first. The key a shows the axes, too; q or Ctrl-C ends it, and the axes go on. While it runs, gateways tell
where moving axes are, twice a second.

  tmclctl --fleet mqtts://broker.example --cert anna.crt --key anna.key fleet top
)";

}  // namespace

Form add_fleet(Grammar& grammar) {
  const auto group = grammar.group("fleet", "Many gateways, on an MQTT broker", fleet_help);
  grammar.verb<verb::FleetGateways>(group, "gateways", access::fleet_only(VerbEffect::reads),
                                    "List the gateways", gateways_help, run_in_fleet);
  auto top =
      grammar.verb<verb::FleetTop>(group, "top", access::fleet_only(VerbEffect::reads),
                                   "Show all gateways on the whole terminal", top_help, show_top);
  auto& interval = top->interval;
  top.option("--interval", "MS", "Draw at most once in so many milliseconds (default 500)",
             milliseconds(interval));
  top.flag("--axes", "Each axis in a line of its own, too", top->axes);
  top.internal(top->internal);
  return group;
}

}  // namespace tmclctl
