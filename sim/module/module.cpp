#include "sim/module/module.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tmcl/command_type.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

// Far more than a module has to do at one instant.
constexpr unsigned most_rounds_at_once = 10'000;
constexpr std::int32_t eeprom_is_valid = 228;
constexpr std::int32_t no_board_error = 0;
constexpr std::int32_t ascii_at_start = 1;

EepromCell global_cell(std::uint8_t number) {
  return {EepromCell::Area::global_parameter, Globals::parameter_bank, number};
}

Eeprom delivered(ModuleAddress address) {
  Eeprom eeprom;
  eeprom.preset(global_cell(gp::serial_address), reply_byte(address));
  eeprom.preset(global_cell(gp::can_id), number(address));
  return eeprom;
}

/// Of what a module does not execute for a host.
Status refusal_of(Command command) {
  const auto* row = find_command(static_cast<std::uint8_t>(command));
  const bool only_in_programs = row != nullptr && row->operands && !is_direct(command);
  return only_in_programs ? Status::command_not_available : Status::invalid_command;
}

}  // namespace

Module::Module(const Model& model, ModuleAddress address, const Clock& clock,
               const ModuleSettings& settings)
    : Module(model, delivered(address), clock, settings) {}

Module::Module(const Model& model, Eeprom eeprom, const Clock& clock,
               const ModuleSettings& settings)
    : state_(model, std::move(eeprom), clock, settings) {
  power_up();
}

void Module::power_up() {
  state_.in_bootloader =
      std::exchange(state_.bootloader_wanted, false) || !state_.bootloader.has_firmware();
  state_.firmware = state_.bootloader.firmware_version(state_.delivered_version());
  const auto magic = state_.eeprom.read(global_cell(gp::eeprom_magic)).value_or(eeprom_is_valid);
  if (magic != eeprom_is_valid) state_.eeprom.erase();
  state_.globals = Globals(*state_.model, state_.eeprom, state_.now);
  const bool wants_ascii = (state_.globals.value(gp::ascii_mode) & ascii_at_start) != 0;
  state_.in_ascii_mode = wants_ascii && state_.has_letter() && !state_.in_bootloader;
  state_.io.reset();
  state_.coordinates = Coordinates(*state_.model, state_.eeprom);
  if (state_.keeps_coordinates()) state_.coordinates.load_all(0);
  state_.build_axes();
  state_.events = TargetEvents(state_.model->axes);
  state_.logger = DataLogger(state_.now);
  programs_.start();
  state_.serial.heard(state_.now);
  state_.can.heard(state_.now);
}

void Module::restart() {
  state_.restarts = false;
  state_.deaf_until = state_.now + boot_time;
  power_up();
}

void Module::power_cycle() {
  run_due();
  state_.bootloader_wanted = false;
  restart();
  run_application();
}

void Module::power_off() {
  run_due();
  state_.bootloader_wanted = false;
  restart();
  programs_.application().power_on(false, state_.now);
  state_.deaf_until = TimePoint::max();
}

Answer Module::execute(const Request& request, Medium medium, EventSink& from) {
  run_due();
  if (!hears()) return no_answer;
  heartbeat(medium).heard(state_.now);
  auto answer =
      state_.in_bootloader ? system_.execute_in_bootloader(request) : execute_direct(request, from);
  const bool reads = effect_of(request.command, request.type) == Effect::reads;
  const bool suppressed = state_.globals.value(gp::suppress_reply) != 0 && !state_.in_bootloader;
  if (suppressed && !reads) answer = no_answer;
  if (state_.restarts) restart();
  run_application();
  return answer;
}

Answer Module::execute_direct(const Request& request, EventSink& from) {
  if (programs_.application().in_download() && request.command < Command::STOP_APPLICATION)
    return programs_.application().record(request);
  if (Application::is_control(request.command)) return programs_.control(request);
  if (is_direct_calculation(request.command))
    return programs_.application().execute_directly(request, state_.now);
  switch (request.command) {
    case Command::GET_FIRMWARE_VERSION: return system_.tell_version(request);
    case Command::TARGET_REACHED_EVENT: return system_.arm_event(request, from);
    case Command::FACTORY_RESET: return system_.reset_to_factory_settings(request);
    case Command::SECURITY_CODE: return echo(request);  // nothing here is hidden without it
    case Command::WRITE_MC:
    case Command::READ_MC: return registers_.access_controller(request);
    case Command::WRITE_DRV:
    case Command::READ_DRV: return registers_.access_driver(request);
    case Command::MEASURED_SPEED: return system_.tell_measured_speed(request);
    case Command::BOARD_ERROR: return reading(no_board_error);
    case Command::BOARD_RESET: return system_.reset_board(request);
    case Command::GET_INFO: return system_.tell_info(request);
    case Command::GET_AP_MIN:
    case Command::GET_AP_MAX: return system_.tell_limit(request);
    case Command::SOFTWARE_RESET: return system_.restart_after_reply(request);
    case Command::ENTER_ASCII_MODE: return system_.enter_ascii_mode(request);
    case Command::ENTER_BOOTLOADER: return system_.enter_bootloader(request);
    case Command::RAM_DEBUG: return logger_.access(request);
    // Known, but only to firmware for special boards or customers.
    case Command::GET_IDS:
    case Command::WRITE_USER_CHANNEL:
    case Command::READ_USER_CHANNEL: return echo(request, Status::command_not_available);
    default: return perform(request);
  }
}

Answer Module::perform(const Request& request) {
  switch (request.command) {
    case Command::ROR: return motion_.rotate(request, 1);
    case Command::ROL: return motion_.rotate(request, -1);
    case Command::MST: return motion_.stop(request);
    case Command::MVP:
      return request.type == move_type::coordinate ? coordinates_.move(request)
                                                   : motion_.move(request);
    case Command::RFS: return motion_.search(request);
    case Command::SAP: return axis_parameters_.set(request);
    case Command::GAP: return axis_parameters_.get(request);
    case Command::STAP: return axis_parameters_.store(request);
    case Command::RSAP: return axis_parameters_.restore(request);
    case Command::SGP: return global_parameters_.set(request);
    case Command::GGP: return global_parameters_.get(request);
    case Command::STGP: return global_parameters_.store(request);
    case Command::RSGP: return global_parameters_.restore(request);
    case Command::SIO:
      return echo(request, state_.io.set(request.motor, request.type, request.value));
    case Command::GIO: return reading(state_.io.get(request.motor, request.type));
    case Command::SCO: return coordinates_.set(request);
    case Command::GCO: return coordinates_.get(request);
    case Command::CCO: return coordinates_.capture(request);
    case Command::SAC:
    case Command::UF0:
    case Command::UF1:
    case Command::UF2:
    case Command::UF3:
    case Command::UF4:
    case Command::UF5:
    case Command::UF6:
    case Command::UF7: return echo(request, Status::command_not_available);
    default: return echo(request, refusal_of(request.command));
  }
}

TimePoint Module::serial_due() const {
  if (ignores_silence()) return never;
  return state_.serial.due(state_.globals.milliseconds(gp::serial_heartbeat));
}

TimePoint Module::can_due() const {
  if (ignores_silence()) return never;
  return state_.can.due(state_.globals.milliseconds(gp::can_heartbeat));
}

bool Module::ignores_silence() const {
  return state_.settings.traits.get<tmcl::Heartbeat>(Trait::heartbeat, *state_.model) ==
         tmcl::Heartbeat::ignored;
}

void Module::stop_if_silent() {
  const bool serial_silent = serial_due() <= state_.now;
  const bool can_silent = can_due() <= state_.now;
  if (serial_silent) state_.serial.expire();
  if (can_silent) state_.can.expire();
  if (serial_silent || can_silent) state_.stop_all_motors();
}

TimePoint Module::next_due() const {
  auto due =
      std::min({serial_due(), can_due(), state_.events.next_due(state_.axes),
                state_.logger.next_due(), programs_.application().next_due(), supply_.next_due()});
  for (const auto& axis : state_.axes) due = std::min(due, axis.next_due());
  return due;
}

// Each thing that is due leaves with a later time, or none, when it is due next.
void Module::run_due() {
  const auto present = state_.clock->now();
  auto latest = TimePoint::min();
  unsigned rounds_at_once = 0;
  for (auto due = next_due(); due <= present; due = next_due()) {
    rounds_at_once = due > latest ? 0 : rounds_at_once + 1;
    if (rounds_at_once > most_rounds_at_once)
      throw std::logic_error("a module has something to do at one instant for ever");
    latest = std::max(latest, due);
    bring_to(due);
    run_what_is_due_now();
  }
  bring_to(present);
}

void Module::mount(std::size_t motor, const StageSettings& settings) {
  at_stage(motor, [&](Stage& stage) { stage = Stage(settings); });
}

void Module::at_stage(std::size_t motor, const std::function<void(Stage&)>& change) {
  run_due();
  change(state_.stages.at(motor));
  state_.axes.at(motor).stage_changed();
  run_application();
}

void Module::run_application() {
  programs_.application().run_due(state_.now);
  if (state_.shut_down()) state_.stop_all_motors();
}

void Module::bring_to(TimePoint time) {
  state_.now = std::max(state_.now, time);
  for (auto& axis : state_.axes) axis.advance_to(state_.now);
}

void Module::run_what_is_due_now() {
  stop_if_silent();
  supply_.run_due();
  for (auto& axis : state_.axes) axis.run_due();
  state_.events.run_due(state_.now, state_.axes, *this);
  logger_.run_due();
  run_application();
}

bool Module::set_input(std::uint8_t port, bool high) {
  run_due();
  const bool exists = state_.io.set_input(port, high);
  run_application();
  return exists;
}

bool Module::set_analog(std::uint8_t port, std::int32_t value) {
  run_due();
  if (port != Io::supply_voltage_port) return state_.io.set_analog(port, value);
  if (value < 0 || value > Io::greatest_analog) return false;
  set_supply(value);
  return true;
}

void Module::set_supply(std::int32_t supply) {
  run_due();
  supply_.set(supply);
  run_application();
}

void Module::brown_out(Duration duration) {
  run_due();
  supply_.brown_out(duration);
  run_application();
}

bool Module::set_shutdown_input(bool high) {
  if (!global_range(*state_.model, Globals::parameter_bank, gp::shutdown_pin_function))
    return false;
  run_due();
  state_.shutdown_input = high;
  run_application();
  return true;
}

}  // namespace tmcl::sim
