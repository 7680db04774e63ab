/// A gateway, its clients, two buses and their modules in one process, in virtual time: the same
/// from the same seed.
#pragma once

#include <algorithm>
#include <csignal>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/json/serialize.hpp>

#include "api/dispatch.hpp"
#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "config/load.hpp"
#include "gateway/gateway.hpp"
#include "log/log.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/feeding.hpp"
#include "world/host.hpp"
#include "world/ledger.hpp"
#include "world/programs.hpp"
#include "world/standing.hpp"
#include "world/trouble.hpp"
#include "world/wire.hpp"
#include "world/world_peer.hpp"

namespace tmcld::test {

namespace json = boost::json;

/// Three motors of one module on a serial line, and three modules with one motor each on CAN.
class World {
 public:
  /// How long a module is on before its supply fails, at least: one that was on for less than
  /// answers take can start again unnoticed.
  static constexpr tmcl::Duration on_before = std::chrono::seconds(3);

  World(std::uint64_t seed, const Trouble& trouble)
      : seed_(seed),
        trouble_(trouble),
        work_(generator(seed, "work")),
        serial_(context_, "line", tmcl::Framing::serial, seed, trouble.faults, trace_),
        can_(context_, "field", tmcl::Framing::can, seed, trouble.faults, trace_),
        ledger_(axes(), values_are_right(trouble.faults)) {
    std::signal(SIGPIPE, SIG_IGN);
    silence_log();
    time_.set_time_for_work(
        [this] { return tmcl::Duration(std::chrono::microseconds(work_.between(100, 20'000))); });
    add(serial_, "TMCM-3110", 1);
    add(can_, "TMCM-1110", 1);
    add(can_, "TMCM-1240", 3);
    add(can_, "TMCM-1160", 4);
    for (auto* wire : {&serial_, &can_}) {
      wire->forges_fences = trouble.canary == Canary::forged_fences;
      wire->on_request = [this, wire](const tmcl::Request& request) {
        note_deadman();
        const bool is_recorded = downloads_.records(wire->name(), request);
        if (wire->hears(request.address)) downloads_.note(wire->name(), request);
        look_at_ended_programs(*wire);
        if (starts_program(request))
          ended_programs_.on_start({wire->name(), request.address}, time_.now());
        ledger_.on_request(wire->name(), request, time_.now(), is_recorded);
        look_at_standing(*wire, request);
        look_at_feeding(*wire, request);
        if (wire == &serial_) break_after(request);
        look_at_places(*wire);
      };
      wire->on_answer = [this, wire](const tmcl::Request& request, std::int32_t value) {
        ledger_.on_answer(wire->name(), request, value, time_.now());
        downloads_.note(wire->name(), request);
        begin_to_stand(*wire, request);
      };
    }
    break_line();
    if (trouble.programs)
      for (auto* wire : {&serial_, &can_}) deliver_programs(*wire);
    GatewayOptions options;
    options.open_link = [this](const BusConfig& bus) { return wire(bus.name).open(); };
    options.new_epoch = [last = std::int64_t{0}]() mutable { return ++last; };
    options.audit = [this](const AuditEntry& entry) { look_at_audit(entry.text); };
    if (trouble.programs)
      ledger_.moves_by_program = [this](const WorldAxis& axis) {
        return moves_by_program(module_of(axis), axis.address.motor);
      };
    gateway_ =
        Gateway::create(context_.get_executor(), configuration(trouble.canary != Canary::no_limits),
                        std::move(options));
  }

  /// Until every client has made its calls, the gateway has ended, and nothing is left to do.
  void run() {
    gateway_->start();
    for (int i = 0; i < trouble_.clients; ++i) spawn(context_.get_executor(), client(i));
    if (trouble_.gaps) spawn(context_.get_executor(), stand_still());
    if (trouble_.doors) spawn(context_.get_executor(), hosts());
    hosts_ended_ = !trouble_.doors;
    for (auto* wire : {&serial_, &can_})
      if (trouble_.supplies) spawn(context_.get_executor(), fail_supplies(*wire));
    using namespace std::chrono_literals;
    all_ended_ = time_.run_while_not([this] { return has_ended() && hosts_ended_; }, 10min);
    // An axis that could not be stopped may need longer: who insists on that is no line.
    const auto is_on_line = [](const auto& axis) { return axis->claim_kind() == ClaimKind::line; };
    journeys_ended_ = time_.run_while_not(
        [&] { return std::ranges::none_of(gateway_->axes(), is_on_line); }, 20min);
    // Whoever asked for it is gone.
    time_.run_for(10s);
    ledger_.look(time_.now());
    turning_ = ledger_.turning();
    spawn(context_.get_executor(), see_all_stand());
    all_stand_ = time_.run_while_not([this] { return all_stand_; }, 5min);
    gateway_->close();
    time_.run_for(10s);
    look_at_deadman();
    trace_.add(static_cast<std::uint64_t>(time_.now().time_since_epoch().count()));
  }

  /// What was not as it is promised.
  std::vector<std::string> complaints() const {
    auto all = ledger_.complaints();
    if (!all_ended_) all.emplace_back("a call has no end");
    if (!journeys_ended_) all.emplace_back("a line has no end");
    if (!all_stand_) all.emplace_back("a stop of what a program turns has no end");
    for (const auto& axis : turning_) all.push_back(axis + " turns, although nobody is there");
    return all;
  }
  std::uint64_t trace() const { return trace_.value(); }
  const Ledger& ledger() const { return ledger_; }
  std::size_t done_for_hosts() const { return done_for_hosts_; }
  /// Programs that were run in modules, or lines of them.
  std::size_t programs_run() const { return programs_run_; }
  /// Looks at axes that a program let turn.
  std::size_t unattended() const { return unattended_; }
  std::size_t requests() const { return serial_.requests() + can_.requests(); }
  tmcl::TimePoint now() const { return time_.now(); }

 private:
  using Random = tmcl::test::Random<>;
  static constexpr auto axis_with_deadman = "f";
  static constexpr int most_clients = 8;
  static constexpr int brief_client = 3;
  static constexpr int client_of_hosts = most_clients - 1;
  static constexpr int hosts_with_programs = 8;

  static const std::vector<WorldAxis>& axes() {
    using tmcl::ModuleAddress;
    static const std::vector<WorldAxis> all{
        {"a", "line", {ModuleAddress{1}, 0}},  {"b", "line", {ModuleAddress{1}, 1}},
        {"c", "line", {ModuleAddress{1}, 2}},  {"d", "field", {ModuleAddress{1}, 0}, 150'000},
        {"e", "field", {ModuleAddress{3}, 0}}, {"f", "field", {ModuleAddress{4}, 0}}};
    return all;
  }

  static Config configuration(bool with_limits) {
    std::string text = "[daemon]\nsocket = \"/none\"\n";
    text += "[[bus]]\nname = \"line\"\nlink = \"serial:/dev/none@115200\"\n";
    text += "[[bus]]\nname = \"field\"\nlink = \"can:none\"\n";
    for (const auto& axis : axes()) {
      text += "[[axis]]\nname = \"" + axis.name + "\"\nbus = \"" + axis.bus +
              "\"\naddress = " + std::to_string(number(axis.address.module)) +
              "\nmotor = " + std::to_string(axis.address.motor) + "\n";
      if (axis.soft_limit == 0 || !with_limits) continue;
      const auto limit = std::to_string(axis.soft_limit);
      text += "soft_limits = [-" + limit + ", " + limit + "]\n";
    }
    text += "[[module]]\nbus = \"field\"\naddress = 3\nsentinel = \"settings\"\n";
    text += "[[module]]\nbus = \"field\"\naddress = 4\ndeadman_ms = " +
            std::to_string(Feeding::deadman_ms) + "\n";
    return parse_config(text).value();
  }

  static void add(Wire& wire, std::string_view model, std::uint16_t address) {
    wire.bench().add(*tmcl::find_model(model), tmcl::ModuleAddress{address});
  }
  Wire& wire(const std::string& name) { return name == serial_.name() ? serial_ : can_; }

  // ---- clients ----

  boost::asio::awaitable<void> client(int index) {
    auto random = generator(seed_, "client " + std::to_string(index));
    const auto peer = std::make_shared<WorldPeer>(trace_);
    peer->number = gateway_->add_client().number;
    if (trouble_.deaths) spawn(context_.get_executor(), die_at_times(index, peer));
    for (int i = 0; i < trouble_.calls; ++i) {
      co_await rest(std::chrono::microseconds(random.any_size(200'000)));
      json::object params;
      auto call = any_call(random, index, peer->number, params);
      call.client = peer->number;
      auto carried_out = carry_out(peer, std::move(call), std::move(params));
      co_await std::move(carried_out);
      if (is_brief(index)) come_anew(*peer);
    }
    peer->has_ended = true;
    leave(*peer);
    ++ended_;
  }

  /// A part of the calls of a world that has programs.
  bool draws_program(Random& random) const { return trouble_.programs && random.one_in(5); }

  void leave(const WorldPeer& peer) {
    ledger_.on_leave(peer.number, now());
    if (trouble_.canary != Canary::owner_not_missed) gateway_->remove_client(peer.number);
  }

  void look_at_places(Wire& wire) {
    for (const auto& axis : axes()) {
      if (axis.soft_limit == 0 || axis.bus != wire.name()) continue;
      for (const auto& module : wire.bench().modules())
        if (address_of(*module) == axis.address.module)
          ledger_.on_place(
              axis.name,
              *module->axis(axis.address.motor).get(tmcl::axis_parameter::actual_position));
    }
  }
  /// Null if its deadman is not set: it may have heard nothing when it was to be.
  const tmcl::sim::Module* module_with_deadman() {
    can_.bench().run_due();
    for (const auto& module : can_.bench().modules()) {
      const auto set_ms = module->globals().value(tmcl::global_parameter::can_heartbeat);
      if (feeding_.is_of(can_.name(), address_of(*module)) && set_ms == Feeding::deadman_ms)
        return module.get();
    }
    return nullptr;
  }
  /// It stands if nobody has sent it anything for too long.
  void look_at_deadman() {
    const auto* module = module_with_deadman();
    if (module == nullptr || !feeding_.must_stand(now(), time_to_rest(*module))) return;
    if (*module->axis(0).get(tmcl::axis_parameter::actual_velocity) != 0)
      ledger_.complain("a motor turns, although its module got no command for too long");
  }
  static tmcl::Duration time_to_rest(const tmcl::sim::Module& module, std::uint8_t motor = 0) {
    namespace ap = tmcl::axis_parameter;
    std::vector<std::int32_t> dividers;
    for (const auto parameter : tmcl::unit_parameters(module.model()))
      dividers.push_back(*module.axis(motor).get(parameter));
    const auto units = tmcl::module_units(module.model(), dividers).value();
    // It may turn faster than it was set to since.
    const auto fastest = std::max(*module.axis(motor).get(ap::max_velocity),
                                  std::abs(*module.axis(motor).get(ap::actual_velocity)));
    const double speed = fastest * units.velocity.value;
    const double slope = *module.axis(motor).get(ap::max_acceleration) * units.acceleration.value;
    if (slope <= 0) return {};
    const std::chrono::duration<double> time(speed / slope);
    return std::chrono::duration_cast<tmcl::Duration>(time);
  }
  void note_deadman() {
    const auto* module = module_with_deadman();
    if (module != nullptr && feeding_.has_stopped(now(), time_to_rest(*module)))
      ledger_.on_deadman(axis_with_deadman, now());
  }
  void look_at_feeding(const Wire& wire, const tmcl::Request& request) {
    // One that does not answer is not fed.
    const auto* module = module_at(wire, request.address);
    const bool is_ready = module != nullptr && module->state() == GatewayModule::State::ready;
    const bool is_fed = is_ready && module_with_deadman() != nullptr;
    if (feeding_.is_of(wire.name(), request.address) && !is_fed) feeding_.on_pause(now());
    const auto fault = feeding_.on_request(wire.name(), request, now());
    if (!fault.empty()) ledger_.complain(fault);
  }

  // ---- what its module does ----

  const tmcl::sim::Module& module_of(const WorldAxis& axis) {
    auto& bench = wire(axis.bus).bench();
    bench.run_due();
    const auto found = std::ranges::find_if(bench.modules(), [&](const auto& module) {
      return address_of(*module) == axis.address.module;
    });
    return **found;
  }
  bool turns(const WorldAxis& axis) {
    return *module_of(axis).axis(axis.address.motor).get(tmcl::axis_parameter::actual_velocity) !=
           0;
  }
  bool turns_without_end(const WorldAxis& axis) {
    const auto& module = module_of(axis);
    const auto& motor = module.axis(axis.address.motor);
    const auto mode = tmcl::mode_parameter(tmcl::axis_parameters(module.model()));
    // One that does not tell it is not asked.
    if (!mode) return false;
    const bool by_velocity = may_turn_in(*mode, *motor.get(mode->number)) &&
                             *motor.get(tmcl::axis_parameter::target_velocity) != 0;
    return by_velocity && turns(axis) && motor.search_step() == 0;
  }

  void look_at_ended_programs(const Wire& wire) {
    for (const auto& axis : axes()) {
      if (axis.bus != wire.name()) continue;
      const auto count = moves_by_program(module_of(axis), axis.address.motor);
      if (ended_programs_.go_on({axis.bus, axis.address.module}, count))
        ledger_.complain("the program of " + axis.name + " goes on after system.stop_all");
    }
  }
  void note_ended_programs(tmcl::TimePoint called, const json::object& stopped) {
    if (!values_are_right(trouble_.faults)) return;
    for (const auto& axis : axes()) {
      const auto count = moves_by_program(module_of(axis), axis.address.motor);
      if (json::serialize(stopped.at("failed")).find('"' + axis.name + '"') == std::string::npos)
        ended_programs_.on_stop_of_all({axis.bus, axis.address.module}, called, count);
    }
  }

  /// Its module has taken a stop: from then on it comes to rest.
  void begin_to_stand(const Wire& wire, const tmcl::Request& request) {
    for (const auto& axis : axes()) {
      if (axis.bus != wire.name() || axis.address.module != request.address) continue;
      if (!Ledger::is_stop_of(axis, request)) continue;
      const auto& module = module_of(axis);
      if (module.axis(axis.address.motor).search_step() != 0) continue;
      standing_.begin(axis.name, now() + 2 * time_to_rest(module, axis.address.motor));
    }
  }
  /// Unless something moves it again.
  void look_at_standing(const Wire& wire, const tmcl::Request& request) {
    for (const auto& axis : axes())
      if (axis.bus == wire.name() && axis.address.module == request.address &&
          Ledger::is_stop_of(axis, request))
        standing_.ask(axis.name, moves_by_program(module_of(axis), axis.address.motor));
    if (standing_.empty()) return;
    for (const auto& axis : axes()) {
      const bool is_its_module = axis.bus == wire.name() && axis.address.module == request.address;
      if (is_its_module && Ledger::moves(request, axis.address.motor)) standing_.end(axis.name);
      const auto count = standing_.count_of(axis.name, now());
      if (!count) continue;
      const bool is_moved = moves_by_program(module_of(axis), axis.address.motor) != *count;
      if (!is_moved && turns(axis)) ledger_.complain(axis.name + " goes on after a stop");
      standing_.end(axis.name);
    }
  }

  void look_at_audit(const std::string& line) {
    const bool runs = line.find("program.run") != std::string::npos ||
                      line.find("program.step") != std::string::npos ||
                      line.find("RUN_APPLICATION") != std::string::npos ||
                      line.find("STEP_APPLICATION") != std::string::npos;
    const bool is_done = line.find("outcome=done") != std::string::npos;
    if (runs && is_done && !line.ends_with("unattended"))
      ledger_.complain("the audit does not say that it is unattended: " + line);
    programs_run_ += runs && is_done ? 1U : 0U;
  }

  /// When all clients have gone nothing turns without end but by a program, and of that it is said.
  /// Then it is stopped: first the program, and then the motor.
  boost::asio::awaitable<void> see_all_stand() {
    const auto peer = std::make_shared<WorldPeer>(trace_);
    peer->number = gateway_->add_client().number;
    for (const auto& axis : axes()) {
      if (!turns_without_end(axis)) continue;
      if (moves_by_program(module_of(axis), axis.address.motor) == 0) {
        ledger_.complain(axis.name + " turns, and no program has moved it");
        continue;
      }
      auto said = say_that_it_is_unattended(peer, axis);
      co_await std::move(said);
      auto stopped = stop_program_and_motor(peer, axis);
      co_await std::move(stopped);
    }
    gateway_->remove_client(peer->number);
    all_stand_ = true;
  }

  boost::asio::awaitable<void> say_that_it_is_unattended(std::shared_ptr<WorldPeer> peer,
                                                         WorldAxis axis) {
    const auto before = moves_by_program(module_of(axis), axis.address.motor);
    json::object params{{"axis", axis.name}};
    auto request = request_of({.method = "axis.get_state", .axes = {axis.name}}, std::move(params));
    const auto state = co_await dispatch(gateway_, peer, std::move(request));
    if (state) look_whether_it_is_said(axis.name, before, *state);
  }
  /// How often programs have moved it, where one lets it turn.
  std::optional<std::int32_t> turned_by_program(const std::string& name) {
    const auto& axis = *std::ranges::find(axes(), name, &WorldAxis::name);
    if (!trouble_.programs || !ledger_.was_moved_by_program(name) || !turns_without_end(axis))
      return std::nullopt;
    return moves_by_program(module_of(axis), axis.address.motor);
  }
  /// What a lease or a call has for itself has an owner.
  void look_whether_it_is_said(const std::string& name, std::int32_t before,
                               const json::object& state) {
    const auto of_gateway = gateway_->axes();
    const auto found =
        std::ranges::find_if(of_gateway, [&](const auto& axis) { return axis->name() == name; });
    const bool is_owned =
        (*found)->holder().client != 0 || (*found)->claim_kind() != ClaimKind::none;
    const bool goes_on = turned_by_program(name) == before && state.at("velocity_internal") != 0;
    // What says that it turns without end was asked for behind the velocity, and did not come.
    constexpr std::int64_t reply_timeout_ms = 100;
    const bool is_unknown = state.at("age_ms").as_int64() >= reply_timeout_ms;
    if (is_owned || !goes_on || is_unknown) return;
    ++unattended_;
    if (state.at("unattended") != true)
      ledger_.complain("a program turns " + name +
                       ", and that is not said to be unattended: " + json::serialize(state));
  }

  boost::asio::awaitable<void> stop_program_and_motor(std::shared_ptr<WorldPeer> peer,
                                                      WorldAxis axis) {
    const auto module = number(axis.address.module);
    const std::vector<std::pair<std::string, json::object>> calls{
        {"program.stop", {{"bus", axis.bus}, {"address", module}}},
        {"axis.stop", {{"axis", axis.name}}}};
    for (const auto& [method, params] : calls) {
      bool is_done = false;
      for (int tries = 5; tries > 0 && !is_done; --tries) {
        auto request = request_of({.method = method, .axes = {axis.name}}, params);
        const auto answer = co_await dispatch(gateway_, peer, std::move(request));
        is_done = answer.has_value();
      }
      if (!is_done) ledger_.complain(method + " is not done, for " + axis.name);
    }
    co_await rest(2 * time_to_rest(module_of(axis), axis.address.motor) + std::chrono::seconds(1));
    if (turns(axis)) ledger_.complain(axis.name + " turns on, although its program has ended");
  }

  const GatewayModule* module_at(const Wire& wire, tmcl::ModuleAddress address) const {
    for (const auto& bus : gateway_->buses())
      if (bus->name() == wire.name()) return bus->find_module(address);
    return nullptr;
  }
  static tmcl::ModuleAddress address_of(const tmcl::sim::Module& module) {
    return tmcl::ModuleAddress{
        static_cast<std::uint16_t>(module.globals().value(tmcl::global_parameter::can_id))};
  }

  /// The client loses its connection, whatever it has begun, and comes back.
  boost::asio::awaitable<void> die_at_times(int index, std::shared_ptr<WorldPeer> peer) {
    auto random = generator(seed_, "death of " + std::to_string(index));
    while (true) {
      co_await rest(std::chrono::milliseconds(random.between(100, 5'000)));
      if (peer->has_ended) break;
      come_anew(*peer);
    }
  }

  void come_anew(WorldPeer& peer) {
    leave(peer);
    peer.number = gateway_->add_client().number;
  }
  /// It has a connection for each call, as programs have that POST.
  bool is_brief(int index) const { return trouble_.doors && index == brief_client; }
  bool has_ended() const { return ended_ == trouble_.clients; }

  // ---- hosts at ports ----

  /// One after the other, for as long as clients call.
  boost::asio::awaitable<void> hosts() {
    auto random = generator(seed_, "hosts");
    while (!has_ended()) {
      co_await visit(random, random.one_in(2) ? serial_.name() : can_.name());
      co_await rest(std::chrono::milliseconds(random.between(0, 1'000)));
    }
    hosts_ended_ = true;
  }

  /// One that has gone may have asked for the same: their programs stand at other places.
  int number_of_host() const { return client_of_hosts + visits_ % hosts_with_programs; }

  /// It goes in the middle of what it has asked for last.
  boost::asio::awaitable<void> visit(Random& random, std::string bus) {
    const auto host = std::make_shared<WorldHost>(gateway_, bus);
    ++visits_;
    for (auto left = random.between(0, 15); left > 0 && !has_ended(); --left) {
      co_await rest(std::chrono::microseconds(random.any_size(500'000)));
      if (draws_program(random)) {
        auto loaded = load(host, random, bus);
        co_await std::move(loaded);
        continue;
      }
      auto asked = ask(host, any_request(random, bus));
      co_await std::move(asked);
    }
    spawn(context_.get_executor(), ask(host, any_request(random, bus)));
    co_await rest(std::chrono::microseconds(random.any_size(500'000)));
    ledger_.on_leave(host->number(), now());
    if (trouble_.canary != Canary::host_not_missed) host->go();
  }

  WorldCall any_request(Random& random, const std::string& bus) const {
    auto on_bus = axes();
    std::erase_if(on_bus, [&](const WorldAxis& axis) { return axis.bus != bus; });
    const auto last = static_cast<std::int64_t>(on_bus.size()) - 1;
    json::object unused;
    if (draws_program(random))
      return raw_program_call(random, number_of_host(), module_for_programs(bus), unused);
    return raw(random, client_of_hosts,
               on_bus[static_cast<std::size_t>(random.between(0, last))].name, unused);
  }

  /// As hosts do it, line by line, until one is not recorded.
  boost::asio::awaitable<void> load(std::shared_ptr<WorldHost> host, Random& random,
                                    std::string bus) {
    using tmcl::Command;
    auto call = WorldCall{.method = "load", .axes = {}};
    const auto chosen = module_for_programs(bus);
    call.axes = names_of(axes_of(chosen));
    call.client = host->number();
    const auto place = program_place(number_of_host());
    call.lines = draw_program(random, number_of_host(), chosen);
    const auto lines = call.lines;
    const auto number = ledger_.begin(std::move(call), now());
    const auto module = chosen.address.module;
    auto begun = say(host, {module, Command::START_DOWNLOAD, 0, 0, place});
    bool goes_on = co_await std::move(begun) == tmcl::Status::ok;
    for (const auto& line : lines) {
      if (!goes_on || random.one_in(20)) break;
      auto said = say(host, tmcld::test::request_of(line, module));
      goes_on = co_await std::move(said) == tmcl::Status::command_loaded;
    }
    auto ended = say(host, {module, Command::END_DOWNLOAD, 0, 0, 0});
    (void)co_await std::move(ended);
    ledger_.end(number, json::object{}, now());
  }

  boost::asio::awaitable<std::optional<tmcl::Status>> say(std::shared_ptr<WorldHost> host,
                                                          tmcl::Request request) {
    host->say(request);
    auto answer = host->answer();
    const auto told = co_await std::move(answer);
    co_return told ? std::optional(told->reply.status) : std::nullopt;
  }

  boost::asio::awaitable<void> ask(std::shared_ptr<WorldHost> host, WorldCall call) {
    call.client = host->number();
    call.method = WorldCall::at_port;
    const auto request = *call.raw;
    const auto number = ledger_.begin(std::move(call), now());
    host->say(request);
    const auto told = co_await host->answer();
    const bool is_done = told && told->reply.status == tmcl::Status::ok;
    Result<json::object> result;
    if (!is_done) result = tl::unexpected(failed("host", told ? "refused" : "silence"));
    if (!is_done) result.error().outcome = tmcl::Outcome::unknown;
    done_for_hosts_ += is_done ? 1 : 0;
    ledger_.end(number, result, now());
    trace_.add(told ? std::to_string(static_cast<int>(told->reply.status)) : "silence");
  }

  /// Of one module after the other, for as long as anybody calls.
  boost::asio::awaitable<void> fail_supplies(Wire& wire) {
    auto random = generator(seed_, "supplies of " + wire.name());
    const auto& modules = wire.bench().modules();
    while (true) {
      co_await rest(on_before + std::chrono::milliseconds(random.between(0, 3'000)));
      if (has_ended()) break;
      const auto last = static_cast<std::int64_t>(modules.size()) - 1;
      auto& module = *modules[static_cast<std::size_t>(random.between(0, last))];
      const auto address = address_of(module);
      const auto watched_by = module_at(wire, address)->sentinel().name();
      ledger_.on_restart(wire.name(), address, now(), watched_by);
      if (feeding_.is_of(wire.name(), address)) feeding_.on_pause(now());
      downloads_.on_restart(wire.name(), address);
      ended_programs_.on_start({wire.name(), address}, now());
      for (const auto& axis : axes())
        if (axis.bus == wire.name() && axis.address.module == address) standing_.end(axis.name);
      wire.power_cycle(module, address);
    }
  }

  /// Of the whole process, for longer than a second, and now and then.
  boost::asio::awaitable<void> stand_still() {
    auto random = generator(seed_, "gaps");
    while (!has_ended()) {
      co_await rest(std::chrono::milliseconds(random.between(500, 8'000)));
      const tmcl::Duration duration = std::chrono::milliseconds(random.between(1'201, 4'000));
      time_.freeze_for(duration);
      look_at_deadman();
      feeding_.on_pause(now());
      ledger_.on_gap(now(), duration);
    }
  }

  boost::asio::awaitable<void> carry_out(std::shared_ptr<WorldPeer> peer, WorldCall call,
                                         json::object params) {
    auto request = request_of(call, std::move(params));
    const auto called = now();
    const auto number = ledger_.begin(call, called);
    const auto turning =
        call.method == "axis.get_state" ? turned_by_program(call.axes.front()) : std::nullopt;
    auto result = co_await dispatch(gateway_, peer, std::move(request));
    if (turning && result) look_whether_it_is_said(call.axes.front(), *turning, *result);
    if (call.method == "system.stop_all" && result) note_ended_programs(called, *result);
    if (trouble_.canary == Canary::no_answer) co_await rest(std::chrono::hours(1));
    break_answer(call, result);
    ledger_.end(number, result, now());
    trace_.add(result ? json::serialize(*result) : result.error().message);
  }

  // ---- what is broken on purpose ----

  static bool is_position(const tmcl::Request& request) {
    constexpr std::uint8_t absolute = 0;
    return request.command == tmcl::Command::MVP && request.type == absolute;
  }

  void break_line() {
    if (trouble_.canary == Canary::unheard_movement) serial_.keeps_from_module = is_position;
    if (trouble_.canary == Canary::unheard_stop)
      serial_.keeps_from_module = [](const tmcl::Request& request) {
        return request.command == tmcl::Command::MST;
      };
    if (trouble_.canary == Canary::program_not_ended)
      serial_.keeps_from_module = [](const tmcl::Request& request) {
        return request.command == tmcl::Command::STOP_APPLICATION;
      };
    if (trouble_.canary != Canary::swapped_value) return;
    serial_.change = [this](tmcl::Reply& reply) {
      if (reply.command == tmcl::Command::GAP) std::swap(reply.value, told_before_);
    };
  }
  /// After this request is on the wire.
  void break_after(const tmcl::Request& request) {
    if (!is_position(request)) return;
    const bool is_first = std::exchange(last_position_, request) != request;
    if (trouble_.canary == Canary::doubled_movement && is_first) serial_.inject(request);
    if (trouble_.canary != Canary::foreign_movement || !is_first) return;
    auto other = request;
    last_position_->value = ++other.value;
    serial_.inject(other);
  }
  /// Before the client has it.
  void break_answer(const WorldCall& call, Result<json::object>& result) {
    if (trouble_.canary == Canary::wrong_outcome && !result)
      result.error().outcome = tmcl::Outcome::not_sent;
    if (trouble_.canary == Canary::program_not_told && call.program && result) {
      result->erase("warnings");
      (*result)["unattended"] = false;
    }
    if (trouble_.canary != Canary::movement_after_stop || call.method != "axis.stop") return;
    const auto all = axes();
    const auto axis = std::ranges::find(all, call.axes.front(), &WorldAxis::name);
    const bool moved = last_position_ && last_position_->motor == axis->address.motor;
    if (moved && axis->bus == serial_.name() && result) serial_.inject(*last_position_);
  }

  static RpcRequest request_of(const WorldCall& call, json::object params) {
    const json::object line{
        {"jsonrpc", "2.0"}, {"id", 1}, {"method", call.method}, {"params", std::move(params)}};
    auto request = parse_request(json::serialize(line)).request;
    if (!request) throw std::logic_error(call.method + ": " + request.error().message);
    return std::move(*request);
  }

  /// No two clients ask for the same: of two at once the ledger could not tell which was sent.
  static std::int32_t of_client(std::int64_t value, int client) {
    return static_cast<std::int32_t>(value - value % most_clients + client);
  }
  static std::int32_t far(Random& random, int client) {
    return of_client(random.between(-200'000, 200'000), client);
  }

  WorldCall any_call(Random& random, int client, std::uint64_t number, json::object& params) const {
    static const auto all = axes();
    const auto& axis = all[static_cast<std::size_t>(random.between(0, 5))].name;
    params["axis"] = axis;
    if (draws_program(random)) return program_call(random, client, params);
    const auto value = far(random, client);
    switch (random.between(0, trouble_.raw ? 27 : 21)) {
      case 0:
      case 1: return {"axis.stop", {axis}};
      case 2: params.clear(); return {"system.stop_all", names_of(all)};
      case 3:
        // Where it ends is not known before: of two at once nobody could tell which was sent.
        if (client != 0) return {"axis.stop", {axis}};
        params["distance_microsteps"] = value;
        return {"axis.move_by", {axis}, {}, value};
      case 4:
      case 5:
      case 6: params["position_microsteps"] = value; return {"axis.move_to", {axis}, {value}};
      case 7: {
        const auto velocity = of_client(value / 200, client);
        params["velocity_internal"] = velocity;
        return {"axis.rotate", {axis}, {velocity}};
      }
      case 8:
      case 9: return line(random, client, params);
      case 10:
        params["parameter"] = 4;
        params["value"] = random.between(100, 1000);
        return {"parameter.set", {axis}};
      case 11:
        params["parameter"] = 0;
        params["value"] = value;
        return {"parameter.set", {axis}, {value}};
      case 12:
      case 13: return {"axis.recover", {axis}};
      case 14:
        // Of two at once nobody could tell which has begun.
        if (client != 1 || axis == "d") return {"axis.recover", {axis}};
        params["timeout_ms"] = random.between(1, 2000);
        if (random.one_in(2)) params["mode"] = 1;
        return {"axis.home", {axis}};
      case 15: params["timeout_ms"] = random.between(1, 1000); return {"axis.wait", {axis}};
      case 16: return lease(random, number, params);
      case 17: {
        const auto parameter = random.between(0, 5);
        params["parameter"] = parameter;
        return {.method = "parameter.get", .axes = {axis}, .about = parameter};
      }
      case 22: return coordinate(random, client, axis, params);
      case 23:
      case 24:
      case 25:
      case 26:
      case 27: return raw(random, client, axis, params);
      default: return {"axis.get_state", {axis}};
    }
  }

  // ---- programs ----

  /// Whose axes have no limits that a program could pass, and whose motors no deadman stops.
  static WorldAxis module_for_programs(const std::string& bus) {
    const auto all = axes();
    return *std::ranges::find_if(all, [&](const WorldAxis& axis) {
      return axis.bus == bus && axis.soft_limit == 0 && axis.name != axis_with_deadman;
    });
  }
  static std::vector<WorldAxis> axes_of(const WorldAxis& of_module) {
    auto all = axes();
    std::erase_if(all, [&](const WorldAxis& axis) {
      return axis.bus != of_module.bus || axis.address.module != of_module.address.module;
    });
    return all;
  }
  static tmcl::program::Program draw_program(Random& random, int client, const WorldAxis& module) {
    const auto last = static_cast<std::int64_t>(axes_of(module).size()) - 1;
    const auto position = far(random, client);
    return any_program(random, program_place(client),
                       static_cast<std::uint8_t>(random.between(0, last)), position,
                       of_client(position / 200, client));
  }

  /// A module has a program for each client from the start; they may load others.
  void deliver_programs(Wire& wire) {
    auto random = generator(seed_, "programs of " + wire.name());
    const auto axis = module_for_programs(wire.name());
    tmcl::program::Program all;
    for (int client = 0; client < client_of_hosts + hosts_with_programs; ++client) {
      all.resize(program_place(client));
      std::ranges::copy(draw_program(random, client, axis), std::back_inserter(all));
    }
    for (const auto& module : wire.bench().modules()) {
      if (address_of(*module) != axis.address.module) continue;
      module->eeprom().write_program(tmcl::program::to_bytes(all));
      module->power_cycle();
    }
  }

  static WorldCall program_call(Random& random, int client, json::object& params) {
    const auto module = module_for_programs(random.one_in(2) ? "line" : "field");
    const json::object place{{"bus", module.bus}, {"address", number(module.address.module)}};
    const auto names = names_of(axes_of(module));
    switch (random.between(0, 8)) {
      case 0:
      case 1: return mint(random, client, params);
      case 2:
      case 3: {
        WorldCall call{.method = "program.load", .axes = names};
        call.lines = draw_program(random, client, module);
        params = place;
        params["program"] = tmcl::program::to_hex(call.lines);
        params["first_address"] = program_place(client);
        // The first is loaded last, and nothing stands there meanwhile.
        call.lines.push_back({});
        return call;
      }
      case 4:
      case 5: {
        WorldCall call{.method = "program.run", .axes = names};
        call.program = tmcl::Request{module.address.module, tmcl::Command::RUN_APPLICATION, 1, 0,
                                     program_place(client)};
        params = place;
        params["first_address"] = program_place(client);
        return call;
      }
      case 6: params = place; return {random.one_in(2) ? "program.stop" : "program.reset", names};
      case 7: {
        // Of two at once it is not known which was sent.
        if (client != 1) {
          const auto last = static_cast<std::int64_t>(names.size()) - 1;
          const auto& axis = names[static_cast<std::size_t>(random.between(0, last))];
          params["axis"] = axis;
          return {"axis.get_state", {axis}};
        }
        params = place;
        WorldCall call{.method = "program.step", .axes = names};
        call.program = tmcl::Request{module.address.module, tmcl::Command::STEP_APPLICATION};
        return call;
      }
      default: return raw_program_call(random, client, module, params);
    }
  }

  static WorldCall raw_program_call(Random& random, int client, const WorldAxis& module,
                                    json::object& params) {
    using tmcl::Command;
    constexpr std::uint8_t from_address = 1;
    const bool runs = random.one_in(2);
    const auto ends = random.one_in(2) ? Command::STOP_APPLICATION : Command::RESET_APPLICATION;
    auto call = runs ? raw_call(module.name, Command::RUN_APPLICATION, from_address,
                                program_place(client), params, {})
                     : raw_call(module.name, ends, 0, 0, params, {});
    call.axes = names_of(axes_of(module));
    if (runs) call.program = call.raw;
    return call;
  }

  /// Moves its axes together, once or twice.
  static WorldCall mint(Random& random, int client, json::object& params) {
    const auto chosen = some_axes(random, 1, 3);
    WorldCall call{.method = "mint.run", .axes = names_of(chosen)};
    json::array names;
    for (const auto& axis : chosen) names.emplace_back(axis.name);
    std::string text = "SPEED = 40000;\nACCEL = 400000;\n";
    for (auto groups = random.between(1, 2); groups > 0; --groups) {
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        call.values.push_back(of_client(random.between(-50'000, 50'000), client));
        text += "MOVEA." + std::to_string(i) + " = " + std::to_string(call.values.back()) + "\n";
      }
      text += "GO\n";
    }
    params = {{"axes", std::move(names)}, {"text", text}};
    return call;
  }

  static WorldCall coordinate(Random& random, int client, const std::string& axis,
                              json::object& params) {
    const auto number = static_cast<std::uint8_t>(random.between(1, 2));
    params["number"] = number;
    // As of a search: of two at once nobody could tell which was sent.
    if (client == 2 && !random.one_in(2))
      return {.method = "coordinate.move", .axes = {axis}, .coordinate = number};
    params["position_microsteps"] = far(random, client);
    return {"coordinate.set", {axis}};
  }

  /// A command as it goes on the wire: one that moves, sets or stops.
  WorldCall raw(Random& random, int client, const std::string& axis, json::object& params) const {
    using tmcl::Command;
    namespace ap = tmcl::axis_parameter;
    const auto value = far(random, client);
    const auto speed = of_client(value / 200, client);
    // Soft limits do not hold for raw commands.
    const bool is_limited = axis == "d";
    switch (is_limited ? random.between(6, 7) : random.between(0, 7)) {
      case 0:
        // As of a distance above.
        if (client != 0) break;
        return raw_call(axis, Command::MVP, tmcl::move_type::relative, value, params, {}, value);
      case 1:
        return raw_call(axis, Command::MVP, tmcl::move_type::absolute, value, params, {value});
      case 2: return raw_call(axis, Command::ROR, 0, speed, params, {speed});
      case 3: return raw_call(axis, Command::ROL, 0, speed, params, {-speed});
      case 4: return raw_call(axis, Command::SAP, ap::target_position, value, params, {value});
      case 5: return raw_call(axis, Command::SAP, ap::target_velocity, speed, params, {speed});
      case 6: return raw_call(axis, Command::SAP, ap::max_velocity, 1'000, params, {});
      default: break;
    }
    return raw_call(axis, Command::MST, 0, 0, params, {});
  }

  static WorldCall raw_call(const std::string& name, tmcl::Command command, std::uint8_t type,
                            std::int32_t value, json::object& params,
                            std::vector<std::int32_t> values,
                            std::optional<std::int32_t> distance = {}) {
    static const auto all = axes();
    const auto& axis = *std::ranges::find(all, name, &WorldAxis::name);
    const auto module = number(axis.address.module);
    params = {
        {"bus", axis.bus}, {"address", module},           {"command", static_cast<int>(command)},
        {"type", type},    {"motor", axis.address.motor}, {"value", value}};
    WorldCall call{"module.execute", {name}, std::move(values), distance};
    call.raw = tmcl::Request{axis.address.module, command, type, axis.address.motor, value};
    return call;
  }

  WorldCall lease(Random& random, std::uint64_t client, json::object& params) const {
    const auto held = ledger_.leases_of(client);
    if (held.empty()) {
      auto chosen = some_axes(random, 1, 3);
      json::array names;
      for (const auto& axis : chosen) names.emplace_back(axis.name);
      params = {{"axes", std::move(names)}, {"ttl_ms", random.between(200, 3000)}};
      return {"lease.acquire", names_of(chosen)};
    }
    // In a world the epoch of a lease is its number.
    params = {{"lease", held.front()}, {"epoch", held.front()}};
    const auto* method = random.one_in(2) ? "lease.renew" : "lease.release";
    return {.method = method, .axes = {}, .about = held.front()};
  }

  static WorldCall line(Random& random, int client, json::object& params) {
    const auto chosen = some_axes(random, 2, 4);
    json::array names, positions;
    std::vector<std::int32_t> values;
    for (const auto& axis : chosen) {
      values.push_back(far(random, client));
      names.emplace_back(axis.name);
      positions.emplace_back(values.back());
    }
    params = {{"axes", std::move(names)}, {"positions_microsteps", std::move(positions)}};
    return {"line.move", names_of(chosen), std::move(values)};
  }

  static std::vector<WorldAxis> some_axes(Random& random, std::int64_t least, std::int64_t most) {
    auto chosen = axes();
    for (std::size_t i = chosen.size() - 1; i > 0; --i)
      std::swap(chosen[i],
                chosen[static_cast<std::size_t>(random.between(0, static_cast<std::int64_t>(i)))]);
    chosen.resize(static_cast<std::size_t>(random.between(least, most)));
    return chosen;
  }

  static std::vector<std::string> names_of(const std::vector<WorldAxis>& axes) {
    std::vector<std::string> names;
    for (const auto& axis : axes) names.push_back(axis.name);
    return names;
  }

  std::uint64_t seed_;
  Trouble trouble_;
  boost::asio::io_context context_{1};
  tmcl::VirtualTime time_{context_};
  Trace trace_;
  Random work_;
  Wire serial_;
  Wire can_;
  Ledger ledger_;
  Feeding feeding_{"field", tmcl::ModuleAddress{4}};
  Downloads downloads_;
  Standing standing_;
  EndedPrograms ended_programs_;
  int visits_ = 0;  ///< Of hosts.
  std::size_t programs_run_ = 0;
  std::size_t unattended_ = 0;
  bool all_stand_ = false;
  std::shared_ptr<Gateway> gateway_;
  std::optional<tmcl::Request> last_position_;  ///< That the line's module was sent to.
  std::int32_t told_before_ = 0;
  int ended_ = 0;
  bool hosts_ended_ = false;
  std::size_t done_for_hosts_ = 0;
  bool all_ended_ = false;
  bool journeys_ended_ = false;
  std::vector<std::string> turning_;
};

}  // namespace tmcld::test
