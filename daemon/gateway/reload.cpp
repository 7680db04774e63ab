#include "gateway/reload.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "async/gather.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;

using Buses = std::vector<std::shared_ptr<GatewayBus>>;
using Objection = std::optional<std::string>;

/// Nothing may be sent while it is asked whether motors rest; then they are asked once more.
constexpr int most_looks = 5;
constexpr tmcl::Duration time_to_look = std::chrono::seconds(2);

// ---- whose axes are -----------------------------------------------------------------------------

std::string_view what_moves(ClaimKind kind) {
  switch (kind) {
    case ClaimKind::line: return "is on a line";
    case ClaimKind::path: return "is on a path";
    case ClaimKind::mint: return "is moved by a Mint program";
    case ClaimKind::jog: return "is jogged";
    case ClaimKind::approach: return "is on its way to its target";
    case ClaimKind::search: return "searches its reference";
    case ClaimKind::deadman_test: return "is in a test of its deadman";
    case ClaimKind::verification: return "is held against its twin";
    case ClaimKind::tuning: return "is tuned";
    case ClaimKind::settings: return "is given its settings";
    case ClaimKind::stop: return "could not be stopped, and is not known to stand";
    case ClaimKind::none: break;
  }
  return {};
}

Objection objection_of(const Gateway& gateway, const GatewayAxis& axis) {
  const auto say = [&](std::string_view what, std::string_view hint) {
    return fmt::format("axis '{}' {}: {}", axis.name(), what, hint);
  };
  if (axis.claim_kind() != ClaimKind::none)
    return say(what_moves(axis.claim_kind()), "wait for its end, or stop it");
  if (const auto* lease = gateway.leases()->of(axis))
    return say("is leased by " + lease->holder.name, "wait until it is given back");
  if (axis.turns()) return say("turns", "stop it");
  if (axis.latched())
    return say("is latched, which would be forgotten", "search its reference or recover it");
  return std::nullopt;
}

Objection objection_of_owners(const Gateway& gateway, const Buses& buses) {
  if (!buses.empty() && !gateway.uploads.empty())
    return "firmware is being uploaded to " + *gateway.uploads.begin() + ": wait for its end";
  for (const auto& bus : buses) {
    if (bus->link().scanning) return "bus '" + bus->name() + "' is being scanned: wait for its end";
    for (const auto& axis : gateway.all_axes()) {
      if (&axis->bus() != bus.get()) continue;
      if (auto objection = objection_of(gateway, *axis)) return objection;
    }
  }
  return std::nullopt;
}

// ---- whether they rest --------------------------------------------------------------------------

std::set<tmcl::AxisAddress> motors_to_ask(const Gateway& gateway, const GatewayBus& bus) {
  auto motors = bus.motors().others_that_may_move();
  for (const auto& axis : gateway.all_axes()) {
    const bool answers = axis->module().state() == GatewayModule::State::ready;
    if (&axis->bus() == &bus && answers) motors.insert(axis->address());
  }
  return motors;
}

/// What does not answer says nothing: its address must be correctable.
awaitable<Objection> objection_of_motor(std::shared_ptr<GatewayBus> bus, tmcl::AxisAddress motor,
                                        std::string name) {
  RunOptions options;
  options.deadline = bus->clock().now() + time_to_look;
  auto script = tmcl::verbs::get(motor, tmcl::axis_parameter::actual_velocity);
  const auto velocity = co_await bus->run(std::move(script), std::move(options));
  if (!velocity || *velocity == 0) co_return std::nullopt;
  co_return fmt::format("axis '{}' moves: stop it, or wait until it stands", name);
}

awaitable<Objection> objection_of_motion(std::shared_ptr<Gateway> gateway, const Buses& buses) {
  std::vector<awaitable<Objection>> questions;
  for (const auto& bus : buses) {
    if (bus->state() != GatewayBus::State::open) continue;
    for (const auto& motor : motors_to_ask(*gateway, *bus)) {
      const auto axis = gateway->find_axis(*bus, motor);
      const auto name = axis ? axis->name() : gateway->raw_name(*bus, motor);
      questions.push_back(objection_of_motor(bus, motor, name));
    }
  }
  auto answers = co_await gather(std::move(questions));
  const auto found = std::ranges::find_if(answers, [](const auto& one) { return one.has_value(); });
  co_return found == answers.end() ? std::nullopt : std::move(*found);
}

/// Changes with everything that is sent and is no question.
std::uint64_t commands_to(const Buses& buses) {
  std::uint64_t commands = 0;
  for (const auto& bus : buses) commands += bus->gate().commands();
  return commands;
}

/// No client has sent anything meanwhile that could set something in motion.
awaitable<Objection> objection_to_closing(std::shared_ptr<Gateway> gateway, const Buses& buses) {
  for (int look = 0; look < most_looks; ++look) {
    const auto commands = commands_to(buses);
    if (auto objection = objection_of_owners(*gateway, buses)) co_return objection;
    auto objection = co_await objection_of_motion(gateway, buses);
    if (objection) co_return objection;
    if (commands == commands_to(buses)) co_return objection_of_owners(*gateway, buses);
  }
  co_return "bus '" + buses.front()->name() + "' is sent commands all the time: try again later";
}

/// The program at a port would speak to a bus that is not there any more.
Objection objection_of_ports(const Config& config, const Buses& buses) {
  for (const auto& port : config.ports) {
    if (std::ranges::find(buses, port.bus, &GatewayBus::name) == buses.end()) continue;
    return fmt::format("bus '{}' is at port '{}', which only a start of tmcld opens anew", port.bus,
                       port.name);
  }
  return std::nullopt;
}

std::string in_words(const Gateway& gateway, const Config& config, const Buses& closed) {
  const auto is_there = [&](const auto& bus) {
    return std::ranges::count(config.buses, bus->name(), &BusConfig::name) != 0;
  };
  const auto anew = static_cast<std::size_t>(std::ranges::count_if(closed, is_there));
  const auto kept = gateway.buses().size() - closed.size();
  return fmt::format("buses: {} as before, {} opened anew, {} new, {} gone; axes: {}", kept, anew,
                     config.buses.size() - kept - anew, closed.size() - anew, config.axes.size());
}

}  // namespace

awaitable<tl::expected<std::string, std::string>> foresee_reload(std::shared_ptr<Gateway> gateway,
                                                                 const Config& config) {
  const auto closed = gateway->changed_by(config);
  if (const auto objection = objection_of_ports(config, closed))
    co_return tl::unexpected(*objection);
  if (!closed.empty()) {
    const auto objection = co_await objection_to_closing(gateway, closed);
    if (objection) co_return tl::unexpected(*objection);
  }
  if (gateway->is_closing()) co_return tl::unexpected(std::string("tmcld is ending"));
  co_return in_words(*gateway, config, closed);
}

awaitable<tl::expected<std::string, std::string>> reload(std::shared_ptr<Gateway> gateway,
                                                         Config config) {
  // Nothing else runs between its end and what follows.
  auto words = co_await foresee_reload(gateway, config);
  if (words) gateway->adopt(config, *words);
  co_return words;
}

}  // namespace tmcld
