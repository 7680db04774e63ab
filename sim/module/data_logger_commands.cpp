// RAM_DEBUG, and what a channel of the data logger reads: what the module would answer a host.
#include "sim/module/command_groups.hpp"

namespace tmcl::sim {
namespace {

using ram_debug::Kind;

// The parts of a select word.
std::uint8_t part(std::uint32_t select, int place) {
  constexpr int byte_bits = 8;
  return static_cast<std::uint8_t>(select >> place * byte_bits & 0xFFU);
}
constexpr int motor_place = 3;
constexpr int selector_value_place = 2;
constexpr int selector_place = 1;
constexpr std::uint32_t most_addresses = 256;

// A value that there is not reads 0.
std::uint32_t value_or_zero(const Answer& answer) {
  return answer.status == Status::ok ? static_cast<std::uint32_t>(answer.value) : 0;
}

}  // namespace

bool DataLoggerCommands::has_data_logger() const {
  return module_.settings.data_logger.value_or(sim::has_data_logger(module_.model->family));
}

Answer DataLoggerCommands::access(const Request& request) {
  if (!has_data_logger()) return echo(request, Status::command_not_available);
  return module_.logger.execute(request, module_.now, probe());
}

void DataLoggerCommands::run_due() { module_.logger.run_due(module_.now, probe()); }

DataLogger::Probe DataLoggerCommands::probe() {
  return [this](const DataLogger::Channel& channel) { return read_channel(channel); };
}

std::uint32_t DataLoggerCommands::read_channel(const DataLogger::Channel& channel) {
  const auto select = channel.select;
  const auto motor = part(select, motor_place);
  Request request{ModuleAddress{}, Command::GAP, part(select, 0), motor};
  switch (channel.kind) {
    case Kind::axis_parameter: return value_or_zero(axes_.get(request));
    case Kind::chip_register:
      if ((select & 0xFFFFU) >= most_addresses) return 0;
      request.command = Command::READ_MC;
      return value_or_zero(registers_.access_controller(request));
    case Kind::stacked_register: return stacked_register(select);
    case Kind::system_tick:
      return static_cast<std::uint32_t>((module_.now - module_.logger.power_on()) /
                                        std::chrono::milliseconds(1));
    case Kind::analog_input:
      request.motor = Io::analog_bank;
      return value_or_zero(reading(module_.io.get(request.motor, request.type)));
    case Kind::global_parameter: return value_or_zero(globals_.get(request));
    default: return 0;
  }
}

// One register says which of several another one shows; it is put back afterwards.
std::uint32_t DataLoggerCommands::stacked_register(std::uint32_t select) {
  const auto motor = part(select, motor_place);
  const Request selector{ModuleAddress{}, Command::READ_MC, part(select, selector_place), motor};
  auto choice = selector;
  choice.command = Command::WRITE_MC;
  const auto before = registers_.access_controller(selector).value;
  choice.value = part(select, selector_value_place);
  registers_.access_controller(choice);
  const auto shown = value_or_zero(
      registers_.access_controller({ModuleAddress{}, Command::READ_MC, part(select, 0), motor}));
  choice.value = before;
  registers_.access_controller(choice);
  return shown;
}

}  // namespace tmcl::sim
