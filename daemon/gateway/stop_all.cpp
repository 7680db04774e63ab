#include "gateway/stop_all.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "async/gather.hpp"
#include "gateway/program_end.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using Reports = std::vector<StopReport>;

struct Target {
  std::shared_ptr<GatewayBus> bus;
  tmcl::AxisAddress motor;
  std::shared_ptr<GatewayAxis> axis;  ///< Null where there is none for the motor.
  std::string name;
  std::size_t place = 0;  ///< In the list of all targets of its bus.
  std::tuple<bool, bool, std::size_t> turn{};
};

std::set<tmcl::AxisAddress> other_motors(const Gateway& gateway, const GatewayBus& bus) {
  auto motors = bus.motors().others_that_may_move();
  for (const auto& [address, module] : bus.modules()) {
    const auto* model = module->model();
    for (std::uint8_t motor = 0; model != nullptr && motor < model->axes; ++motor)
      motors.insert({address, motor});
  }
  std::erase_if(motors,
                [&](tmcl::AxisAddress motor) { return gateway.find_axis(bus, motor) != nullptr; });
  return motors;
}

bool has_motor(const GatewayAxis& axis) {
  const auto* model = axis.module().model();
  return model == nullptr || axis.address().motor < model->axes;
}

/// A module that does not answer keeps a serial line busy.
bool delays_others(const Target& target) {
  const auto* module = target.bus->find_module(target.motor.module);
  const bool answers = module != nullptr && module->state() == GatewayModule::State::ready;
  return !answers && !target.bus->is_can();
}

std::vector<Target> targets_of(const Gateway& gateway, const std::shared_ptr<GatewayBus>& bus) {
  std::vector<Target> targets;
  const auto configured = gateway.axes();
  for (const auto& axis : gateway.all_axes()) {
    const bool is_there =
        has_motor(*axis) || std::ranges::find(configured, axis) != configured.end();
    if (&axis->bus() == bus.get() && is_there)
      targets.push_back({bus, axis->address(), axis, axis->name()});
  }
  for (const auto motor : other_motors(gateway, *bus))
    targets.push_back({bus, motor, nullptr, gateway.raw_name(*bus, motor)});
  return targets;
}

awaitable<StopReport> stop_one(Target target, std::uint64_t client) {
  const auto& clock = target.bus->clock();
  const auto began = clock.now();
  StopReport report{target.name, {}, {}};
  if (target.axis) {
    report.result = co_await target.axis->stop(StopCause::client, client);
  } else {
    report.result = co_await target.bus->run(tmcl::verbs::stop(target.motor), asked_by(client));
  }
  report.took = clock.now() - began;
  co_return report;
}

struct Stopped {
  Target target;
  StopReport report{};
};

awaitable<std::vector<Stopped>> stop_motors(std::vector<Target> targets, std::uint64_t client) {
  std::vector<awaitable<StopReport>> stops;
  for (const auto& target : targets) stops.push_back(stop_one(target, client));
  auto reports = co_await gather(std::move(stops));
  std::vector<Stopped> stopped;
  for (std::size_t i = 0; i < targets.size(); ++i)
    stopped.push_back({std::move(targets[i]), std::move(reports[i])});
  co_return stopped;
}

// ---- programs of modules ------------------------------------------------------------------------

StoppedModule module_of(const std::vector<Stopped>& motors) {
  const auto& first = motors.front().target;
  StoppedModule module{first.bus, first.motor.module};
  for (const auto& one : motors) {
    module.motors.push_back(one.target.motor);
    const auto& result = one.report.result;
    if (result || result.error().outcome == tmcl::Outcome::refused) module.has_answered = true;
  }
  return module;
}

/// Motors of one module. Those that its program may move again count as not stopped.
awaitable<std::vector<Stopped>> keep_stopped(std::vector<Stopped> motors, std::uint64_t client) {
  const auto ended = co_await end_program(module_of(motors), client);
  if (!ended) {
    for (auto& one : motors)
      if (one.report.result) one.report.result = tl::unexpected(ended.error());
  } else if (*ended) {
    std::vector<Target> targets;
    for (const auto& one : motors) targets.push_back(one.target);
    auto again = co_await stop_motors(std::move(targets), client);
    for (std::size_t i = 0; i < again.size(); ++i)
      motors[i].report.result = std::move(again[i].report.result);
  }
  co_return motors;
}

/// The motors, and then what could move them again. They come back by modules.
awaitable<std::vector<Stopped>> stop_each(std::vector<Target> targets, std::uint64_t client) {
  std::map<tmcl::ModuleAddress, std::vector<Stopped>> modules;
  auto motors = co_await stop_motors(std::move(targets), client);
  for (auto& one : motors) modules[one.target.motor.module].push_back(std::move(one));
  std::vector<awaitable<std::vector<Stopped>>> ends;
  for (auto& [module, stopped] : modules) ends.push_back(keep_stopped(std::move(stopped), client));
  const auto kept = co_await gather(std::move(ends));
  std::vector<Stopped> all;
  for (const auto& stopped : kept) all.insert(all.end(), stopped.begin(), stopped.end());
  co_return all;
}

/// Those that may move first, and modules in turn; behind all others those that delay them.
void put_in_order(std::vector<Target>& targets) {
  std::map<std::pair<bool, tmcl::ModuleAddress>, std::size_t> turns;
  for (std::size_t place = 0; place < targets.size(); ++place) {
    auto& target = targets[place];
    const bool may_wait = !target.bus->motors().may_move(target.motor);
    target.place = place;
    target.turn = {delays_others(target), may_wait, turns[{may_wait, target.motor.module}]++};
  }
  std::ranges::stable_sort(targets, {}, &Target::turn);
}

/// The reports come in the order of the targets.
awaitable<Reports> stop_bus(std::vector<Target> targets, std::uint64_t client) {
  put_in_order(targets);
  const auto first_delaying = std::ranges::find_if(targets, delays_others);
  const std::vector<Target> first(targets.begin(), first_delaying);
  const std::vector<Target> last(first_delaying, targets.end());
  Reports in_place(targets.size());
  for (const auto* part : {&first, &last}) {
    auto stopped = co_await stop_each(*part, client);
    for (auto& one : stopped) in_place[one.target.place] = std::move(one.report);
  }
  co_return in_place;
}

}  // namespace

awaitable<Reports> stop_all(std::shared_ptr<Gateway> gateway, std::uint64_t client) {
  gateway->revoke_movements();
  std::vector<awaitable<Reports>> stops;
  for (const auto& bus : gateway->buses())
    stops.push_back(stop_bus(targets_of(*gateway, bus), client));
  const StopInProgress in_progress(std::move(gateway));
  auto of_each_bus = co_await gather(std::move(stops));
  std::size_t count = 0;
  for (const auto& reports : of_each_bus) count += reports.size();
  Reports all;
  all.reserve(count);
  for (auto& reports : of_each_bus) std::ranges::move(reports, std::back_inserter(all));
  co_return all;
}

}  // namespace tmcld
