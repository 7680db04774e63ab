// The control functions of stand-alone programs, and what a program sees of the module.
#include <algorithm>

#include "sim/module/module.hpp"
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

void Module::start_application() {
  application_.load(program::from_bytes(eeprom_.program()).value_or(program::Program{}));
  application_.power_on(globals_.value(gp::auto_start_mode) != 0 && !in_bootloader_, deaf_until_);
}

Answer Module::control_application(const Request& request) {
  const bool changes_memory =
      request.command == Command::END_DOWNLOAD && application_.in_download();
  auto answer = application_.execute(request, now_);
  const bool tells_state = request.command == Command::GET_APPLICATION_STATUS;
  if (tells_state && has_state_in_low_byte()) answer = reading(application_.status());
  if (changes_memory && answer.status == Status::ok) keep_program();
  return answer;
}

bool Module::has_state_in_low_byte() const {
  return settings_.traits.get<ProgramState>(Trait::program_state, *model_) ==
         ProgramState::low_byte;
}

void Module::keep_program() {
  eeprom_.write_program(program::to_bytes(used(application_.memory())));
}

void Module::protect_program(std::int32_t before, std::int32_t after) {
  if (application_.change_protection(before, after)) keep_program();
}

std::optional<std::int32_t> Module::application_parameter(std::uint8_t number) const {
  switch (number) {
    case gp::application_status: return application_.status();
    case gp::download_mode: return application_.download_mode();
    case gp::program_counter: return application_.program_counter();
    case gp::tmcl_error: return application_.last_error();
    default: return std::nullopt;
  }
}

std::int32_t Module::code_protection() const { return globals_.value(gp::code_protection); }

MotorConditions Module::motor(std::size_t number) const {
  const auto& axis = axes_.at(number);
  const auto& switches = axis.switches();
  return {
      .at_target = axis.position_reached(),
      .searching = axis.searching(),
      .home_switch = switches.home,
      .left_switch = switches.left,
      .right_switch = switches.right,
      .stalled = axis.stalled(),
      .deviated = axis.deviated(),
  };
}

// No model here has inputs for the others.
Alarms Module::alarms() const {
  return {.deviation = std::ranges::any_of(axes_, &Axis::deviated), .shutdown = shut_down()};
}

TimePoint Module::next_event() const {
  auto next = never;
  for (const auto& axis : axes_) {
    for (const auto time : {axis.outlook().arrival, axis.next_due()}) {
      if (time > now_) next = std::min(next, time);
    }
  }
  return next;
}

}  // namespace tmcl::sim
