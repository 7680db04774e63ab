// The control functions of stand-alone programs, and what a program sees of the module.
#include <algorithm>

#include "sim/module/command_groups.hpp"
#include "tmcl/program.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

/// A program without the empty memory behind it.
std::span<const program::Instruction> used(std::span<const program::Instruction> memory) {
  while (!memory.empty() && memory.back() == program::Instruction{})
    memory = memory.first(memory.size() - 1);
  return memory;
}

}  // namespace

void ProgramCommands::start() {
  application_.load(program::from_bytes(module_.eeprom.program()).value_or(program::Program{}));
  application_.power_on(module_.globals.value(gp::auto_start_mode) != 0 && !module_.in_bootloader,
                        module_.deaf_until);
}

Answer ProgramCommands::control(const Request& request) {
  const bool changes_memory =
      request.command == Command::END_DOWNLOAD && application_.in_download();
  auto answer = application_.execute(request, module_.now);
  const bool tells_state = request.command == Command::GET_APPLICATION_STATUS;
  if (tells_state && has_state_in_low_byte()) answer = reading(application_.status());
  if (changes_memory && answer.status == Status::ok) keep();
  return answer;
}

bool ProgramCommands::has_state_in_low_byte() const {
  return module_.settings.traits.get<ProgramState>(Trait::program_state, *module_.model) ==
         ProgramState::low_byte;
}

void ProgramCommands::keep() {
  module_.eeprom.write_program(program::to_bytes(used(application_.memory())));
}

void ProgramCommands::protect(std::int32_t before, std::int32_t after) {
  if (application_.change_protection(before, after)) keep();
}

std::optional<std::int32_t> ProgramCommands::parameter(std::uint8_t number) const {
  switch (number) {
    case gp::application_status: return application_.status();
    case gp::download_mode: return application_.download_mode();
    case gp::program_counter: return application_.program_counter();
    case gp::tmcl_error: return application_.last_error();
    default: return std::nullopt;
  }
}

std::int32_t ProgramCommands::code_protection() const {
  return module_.globals.value(gp::code_protection);
}

MotorConditions ProgramCommands::motor(std::size_t number) const {
  const auto& axis = module_.axes.at(number);
  const auto& switches = axis.switches();
  return {
      .at_target = axis.position_reached(),
      .searching = axis.search_step() != 0,
      .home_switch = switches.home,
      .left_switch = switches.left,
      .right_switch = switches.right,
      .stalled = axis.stalled(),
      .deviated = axis.deviated(),
  };
}

// No model here has inputs for the others.
Alarms ProgramCommands::alarms() const {
  return {.deviation = std::ranges::any_of(module_.axes, &Axis::deviated),
          .shutdown = module_.shut_down()};
}

TimePoint ProgramCommands::next_event() const {
  auto next = never;
  for (const auto& axis : module_.axes) {
    for (const auto time : {axis.outlook().arrival, axis.next_due()}) {
      if (time > module_.now) next = std::min(next, time);
    }
  }
  return next;
}

}  // namespace tmcl::sim
