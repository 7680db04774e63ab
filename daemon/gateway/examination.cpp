#include "gateway/examination.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "gateway/gateway.hpp"
#include "gateway/module/module_settings.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/heard.hpp"
#include "tmcl/program_verbs.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::Check;

/// Of a subject.
class Notes {
 public:
  Notes(Findings& findings, std::string subject)
      : findings_(findings), subject_(std::move(subject)) {}

  void note(Check check, bool wrong, std::string text) {
    findings_.push_back({check, subject_, wrong, std::move(text), {}});
  }
  void wrong(Check check, std::string text, std::string cure = {}) {
    findings_.push_back({check, subject_, true, std::move(text), std::move(cure)});
  }
  void fine(Check check, std::string text) { note(check, false, std::move(text)); }

 private:
  Findings& findings_;
  std::string subject_;
};

// ---- tmcld itself -------------------------------------------------------------------------------

/// Before tmcld was written.
constexpr std::chrono::sys_days earliest = std::chrono::year{2024} / 1 / 1;

/// That of the computer, also where the gateway runs on virtual time.
void look_at_clock(Notes notes) {
  const bool wrong = tmcl::RealClock::utc() < earliest;
  notes.note(Check::clock, wrong,
             wrong ? "it is years behind" : "it is right, as far as can be seen");
}

/// A computer that slept yesterday is no fault of today.
constexpr tmcl::Duration lately = std::chrono::minutes(10);

void look_at_stalls(const Gateway& gateway, Notes notes) {
  const auto& gaps = gateway.gaps();
  if (gaps.duration() == tmcl::Duration{}) return notes.fine(Check::stalls, "it never stood still");
  const auto ago = gateway.clock().now() - gaps.ended();
  notes.note(Check::stalls, ago < lately,
             fmt::format("it stood still for {:.1f} s, {:.0f} s ago",
                         std::chrono::duration<double>(gaps.duration()).count(),
                         std::chrono::duration<double>(ago).count()));
}

awaitable<void> look_at_journal(const Examined& what, Notes notes) {
  if (what.axes.empty()) co_return;
  const auto failure = co_await what.axes.front()->enter_journal();
  notes.note(Check::journal, !failure.empty(), failure.empty() ? "it can" : failure);
}

// ---- a bus --------------------------------------------------------------------------------------

/// Of a bus: one reply in a hundred that is lost shows mostly.
constexpr std::size_t most_probes = 100;

void look_at_link(const GatewayBus& bus, Notes notes) {
  const bool is_open = bus.state() == GatewayBus::State::open;
  notes.note(Check::bus, !is_open,
             is_open ? "it is open: " + to_string(bus.config().link)
                     : fmt::format("it is {}: {}", name_of(bus.state()), bus.error()));
}

struct Asked {
  std::uint64_t requests = 0;
  std::uint64_t lost = 0;  ///< Of these.
  std::uint64_t garbage_bytes = 0;
};

Asked asked_since(const GatewayBus& bus, const tmcl::BusCounters& before) {
  const auto now = bus.link().counters();
  return {now.requests - before.requests, now.timeouts - before.timeouts,
          now.garbage_bytes - before.garbage_bytes};
}

/// Since `before`: a scan of all addresses had its time-outs, too. A module that does not answer at
/// all is a finding of its own, and says nothing of the line.
void look_at_traffic(const GatewayBus& bus, const tmcl::BusCounters& before, const Asked& in_vain,
                     Notes notes) {
  const auto all = asked_since(bus, before);
  const Asked heard{all.requests - in_vain.requests, all.lost - in_vain.lost,
                    all.garbage_bytes - in_vain.garbage_bytes};
  notes.note(Check::replies, heard.lost > 0,
             heard.requests == 0 ? "no module that answers was asked"
                                 : fmt::format("{} of {} requests to modules that answer were not, "
                                               "just now",
                                               heard.lost, heard.requests));
  notes.note(Check::noise, heard.garbage_bytes > 0,
             heard.garbage_bytes > 0 ? fmt::format("{} came just now", heard.garbage_bytes)
                                     : fmt::format("none just now, {} since it was opened",
                                                   bus.link().counters().garbage_bytes));
}

// ---- a module -----------------------------------------------------------------------------------

template <class T>
awaitable<std::optional<T>> ask(GatewayBus& bus, tmcl::Script<tmcl::Result<T>> script,
                                std::uint64_t client) {
  auto result = co_await bus.run(std::move(script), asked_by(client));
  if (!result) co_return std::nullopt;
  co_return *std::move(result);
}

void look_at_deadman(const GatewayModule& module, Notes& notes) {
  const auto& deadman = module.deadman();
  const auto set = deadman.set_ms();
  if (deadman.wanted_ms() && set && *set != *deadman.wanted_ms())
    return notes.wrong(Check::deadman, fmt::format("it is set to {} ms, and configured as {} ms",
                                                   *set, *deadman.wanted_ms()));
  if (deadman.is_set() && deadman.stops_after_ms() == 0)
    return notes.wrong(Check::deadman, "it is set, and a test has found that it does not work");
  notes.fine(Check::deadman, !set               ? "it is not known"
                             : deadman.is_set() ? fmt::format("it is set to {} ms", *set)
                                                : "it is off");
}

awaitable<void> look_at_program(GatewayBus& bus, tmcl::ModuleAddress address, std::uint64_t client,
                                Notes& notes) {
  const auto status = co_await ask(bus, tmcl::verbs::program_status(address), client);
  if (!status) co_return;
  const bool runs = status->state == tmcl::ProgramStatus::State::running;
  notes.fine(Check::program, runs ? "one runs, and may move its motors by itself" : "none runs");
}

void look_at_settings(const GatewayModule& module, Notes& notes) {
  const auto& config = module.settings_config();
  const auto& drift = module.drift();
  if (!config.wanted || !drift) return;
  if (drift->empty()) return notes.fine(Check::settings, "it has those of " + config.file);
  notes.wrong(Check::settings,
              fmt::format("{} differ from {}, such as: {}", drift->size(), config.file,
                          describe(drift->front(), *config.wanted->model)));
}

/// Asks again and again, to see how many answers get lost.
awaitable<void> probe(GatewayBus& bus, tmcl::ModuleAddress address, std::size_t probes,
                      std::uint64_t client) {
  const tmcl::AxisAddress motor{address, 0};
  for (std::size_t i = 0; i < probes; ++i)
    co_await ask(bus, tmcl::verbs::get(motor, tmcl::axis_parameter::actual_position), client);
}

/// What a line brought after that datagram; nothing if nothing was asked meanwhile.
std::optional<tmcl::HeardVerdict> heard_after(const GatewayBus& bus, std::uint64_t number) {
  tmcl::Heard heard(bus.config().bus_options.host_address);
  bool asked = false;
  for (const auto& entry : bus.link().traffic().after(number, TrafficLog::most)) {
    tmcl::Traffic traffic;
    traffic.at = entry.at;
    traffic.direction = entry.direction;
    asked |= entry.direction == tmcl::Traffic::Direction::out;
    traffic.bytes = std::span(entry.bytes).first(entry.size);
    heard.note(traffic);
  }
  if (!asked) return std::nullopt;
  return heard.verdict();
}

/// And what came instead of its answers.
void note_silence(const GatewayBus& bus, std::uint64_t asked_after, const std::string& text,
                  Notes& notes) {
  if (bus.is_can()) return notes.wrong(Check::module, text);
  const auto heard = heard_after(bus, asked_after);
  // To questions to others.
  if (!heard || heard->kind == tmcl::HeardKind::answers) return notes.wrong(Check::module, text);
  const auto* port = std::get_if<tmcl::SerialName>(&bus.config().link);
  notes.wrong(Check::module, text + ": " + meaning_of(*heard),
              hint_for(heard->kind, port != nullptr ? "serial:" + port->device : ""));
}

/// False if it does not answer.
awaitable<bool> look_at_module(GatewayBus& bus, GatewayModule& module, std::uint64_t client,
                               Notes notes) {
  const auto asked_after = bus.link().traffic().last();
  const auto ready = co_await module.be_ready();
  // It may have fallen silent since it was made ready; one that is known as silent was not asked.
  const auto now = co_await bus.run(tmcl::verbs::identify(module.address()), asked_by(client));
  if (!ready || !now) {
    note_silence(bus, asked_after, (ready ? now.error() : ready.error()).message, notes);
    co_return false;
  }
  const auto* model = module.model();
  const auto firmware = to_string(module.identity()->version);
  notes.fine(Check::module, "it answers, with firmware " + firmware);
  const bool doubled = module.duplicate_suspected();
  notes.note(Check::address, doubled,
             doubled ? "more replies come than requests: two modules may have it"
                     : "one reply comes for each request");
  notes.fine(Check::model, model == nullptr ? fmt::format("model {} is known by its number only",
                                                          module.identity()->version.model)
                                            : "it is a " + std::string(model->name));
  co_await look_at_program(bus, module.address(), client, notes);
  const bool watched = module.sentinel().watches();
  notes.fine(Check::restart,
             watched ? "tmcld looks at its " + module.sentinel().name() : "not always");
  look_at_settings(module, notes);
  look_at_deadman(module, notes);
  co_return true;
}

// ---- an axis ------------------------------------------------------------------------------------

bool is_of_supply(std::string_view fault) {
  return fault == "undervoltage" || fault == "overvoltage";
}
bool is_of_temperature(std::string_view fault) { return fault.starts_with("overtemperature"); }

void look_at_driver(const FaultReport& report, const Faults& unproven, Notes& notes) {
  Faults supply;
  Faults temperature;
  Faults driver;
  for (const auto fault : report.driver_faults())
    (is_of_supply(fault)        ? supply
     : is_of_temperature(fault) ? temperature
                                : driver)
        .push_back(fault);
  const auto volts = report.supply_volts ? fmt::format("{:.1f} V", *report.supply_volts) : "";
  notes.note(Check::supply, !supply.empty(),
             supply.empty() ? (volts.empty() ? "its module does not tell" : volts)
                            : words_for(supply) + (volts.empty() ? "" : ": " + volts));
  notes.note(
      Check::temperature, !temperature.empty(),
      temperature.empty() ? "it reports nothing"
      : report.temperature_celsius
          ? fmt::format("{} at {:.0f} deg C", words_for(temperature), *report.temperature_celsius)
          : words_for(temperature));
  notes.note(Check::driver, !driver.empty(),
             !driver.empty() ? words_for(driver)
             : !unproven.empty()
                 ? "perhaps " + words_for(unproven) + ": it counts while it turns slowly"
                 : "it reports nothing");
}

void look_at_switches(const FaultReport& report, Notes& notes) {
  const bool left = report.has_switch("left");
  const bool right = report.has_switch("right");
  notes.note(Check::switches, left && right,
             left && right ? "both are closed"
             : left        ? "the left one is closed"
             : right       ? "the right one is closed"
                           : "both are open");
}

/// A parameter without which no move begins.
awaitable<void> look_at_value(GatewayAxis& axis, Check check, std::string_view name,
                              std::uint64_t client, Notes& notes) {
  const auto* row = find_parameter(axis.parameters(), name);
  if (row == nullptr) co_return;
  const auto value =
      co_await ask(axis.bus(), tmcl::verbs::get(axis.address(), row->number), client);
  if (value) notes.note(check, *value == 0, fmt::format("{} is {}", name, *value));
}

awaitable<void> look_at_resolution(GatewayAxis& axis, std::uint64_t client, Notes& notes) {
  const auto wanted = axis.microstep_resolution();
  if (!wanted) co_return;
  const auto value = co_await ask(
      axis.bus(), tmcl::verbs::get(axis.address(), tmcl::axis_parameter::microstep_resolution),
      client);
  if (value)
    notes.note(Check::resolution, *value != *wanted,
               fmt::format("it counts {} of a full step, the configuration {}", 1 << (*value & 15),
                           1 << *wanted));
}

void look_at_right_to_move(const GatewayAxis& axis, Notes& notes) {
  const auto latched = axis.latched();
  notes.note(Check::latch, latched.has_value(), latched ? latched->message : "it may move");
  if (axis.needs_reference())
    notes.note(Check::reference, !axis.is_referenced(),
               axis.is_referenced() ? "it has found it"
                                    : "it has not found it, and is sent to no position");
  if (const auto unrestored = unrestored_of(axis); !unrestored.empty())
    notes.wrong(Check::restored, fmt::format("{} are not set back, such as {}", unrestored.size(),
                                             unrestored.front().parameter));
}

/// Nothing is known of a stop from before this gateway began but what the module says.
awaitable<std::optional<StopCause>> cause_of_stop(GatewayAxis& axis, std::uint64_t client) {
  if (const auto known = axis.stop_cause()) co_return known;
  const auto found =
      co_await ask(axis.bus(), find_stop_cause(axis.address(), axis.parameters()), client);
  const bool says_why = found && *found != StopCause::unknown && *found != StopCause::velocity_mode;
  co_return says_why ? found : std::nullopt;
}

awaitable<void> look_at_place(GatewayAxis& axis, std::uint64_t client, Notes& notes) {
  const auto reading = co_await axis.read_state({}, client);
  if (!reading) co_return;
  const auto& state = reading->state;
  const auto scale = co_await axis.scale();
  if (const auto& limits = axis.soft_limits(); limits && scale) {
    auto beyond = tmcl::beyond(*limits, state.position, scale->value_or(tmcl::microsteps_scale()));
    if (beyond && beyond->unit.empty()) beyond->unit = "microsteps";
    notes.note(Check::limits, beyond.has_value(), beyond ? describe(*beyond) : "it is within them");
  }
  std::optional<StopCause> cause;
  if (state.velocity.value == 0 && !state.position_reached)
    cause = co_await cause_of_stop(axis, client);
  notes.note(Check::stop, cause.has_value(),
             cause                       ? fmt::format("it was stopped by: {}", name_of(*cause))
             : state.velocity.value != 0 ? "it moves"
                                         : "it stands");
}

awaitable<void> look_at_axis(GatewayAxis& axis, std::uint64_t client, Notes notes) {
  const auto* model = axis.module().model();
  if (model != nullptr && axis.address().motor >= model->axes) {
    notes.wrong(Check::motor,
                fmt::format("a {} has the motors 0 to {}", model->name, model->axes - 1));
    co_return;
  }
  const auto report = co_await axis.read_faults(client);
  if (report) look_at_driver(*report, axis.unproven_faults(), notes);
  co_await look_at_value(axis, Check::current, "max_current", client, notes);
  co_await look_at_value(axis, Check::velocity, "max_velocity", client, notes);
  co_await look_at_value(axis, Check::acceleration, "max_acceleration", client, notes);
  co_await look_at_resolution(axis, client, notes);
  look_at_right_to_move(axis, notes);
  co_await look_at_place(axis, client, notes);
  if (report) look_at_switches(*report, notes);
}

}  // namespace

awaitable<Findings> examine(std::shared_ptr<Gateway> gateway, Examined what) {
  Findings findings;
  look_at_clock({findings, {}});
  look_at_stalls(*gateway, {findings, {}});
  co_await look_at_journal(what, {findings, {}});
  for (const auto& bus : what.buses) {
    look_at_link(*bus, {findings, bus->name()});
    if (bus->state() != GatewayBus::State::open) continue;
    const auto before = bus->link().counters();
    Asked in_vain;
    std::vector<tmcl::ModuleAddress> addresses;
    for (const auto& axis : what.axes)
      if (&axis->bus() == bus.get() && std::ranges::count(addresses, axis->address().module) == 0)
        addresses.push_back(axis->address().module);
    for (const auto address : addresses) {
      auto name = fmt::format("{}:{}", bus->name(), number(address));
      const auto before_it = bus->link().counters();
      const bool answers = co_await look_at_module(*bus, bus->add_module(address), what.client,
                                                   {findings, std::move(name)});
      if (!answers) {
        const auto asked = asked_since(*bus, before_it);
        in_vain.requests += asked.requests;
        in_vain.lost += asked.lost;
        in_vain.garbage_bytes += asked.garbage_bytes;
        continue;
      }
      co_await probe(*bus, address, most_probes / addresses.size(), what.client);
      for (const auto& axis : what.axes)
        if (&axis->bus() == bus.get() && axis->address().module == address)
          co_await look_at_axis(*axis, what.client, {findings, axis->name()});
    }
    look_at_traffic(*bus, before, in_vain, {findings, bus->name()});
  }
  std::ranges::stable_sort(findings, {}, &tmcl::Finding::check);
  co_return findings;
}

}  // namespace tmcld
