#include "console.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "motor_words.hpp"
#include "number_text.hpp"
#include "tmcl/spelling.hpp"

namespace tmclsim {
namespace {

using tmcl::quoted;

namespace sim = tmcl::sim;
using Words = std::vector<std::string_view>;
using Outcome = tl::expected<void, std::string>;

constexpr std::int32_t most_load = 1'000'000;
constexpr auto switch_names = std::to_array<std::string_view>({"left", "right", "home"});

std::optional<std::int32_t> number_in(std::string_view text) {
  return tmclsim::parse_number<std::int32_t>(text);
}

sim::Module* find_module(sim::Bench& bench, std::int32_t address) {
  const auto found = std::ranges::find_if(bench.modules(), [&](const auto& module) {
    return module->globals().value(tmcl::global_parameter::serial_address) == address;
  });
  return found == bench.modules().end() ? nullptr : found->get();
}

std::string no_such_module(std::string_view address) {
  return "there is no module with the address " + std::string(address);
}

struct Motor {
  sim::Module* module;
  std::size_t number;
};

tl::expected<Motor, std::string> find_motor(sim::Bench& bench, std::string_view text) {
  const auto slash = std::min(text.find('/'), text.size());
  const auto address = number_in(text.substr(0, slash));
  const auto motor = number_in(slash == text.size() ? "" : text.substr(slash + 1));
  if (!address || !motor) {
    return tl::unexpected(quoted(text) + " is not ADDRESS/MOTOR, such as 1/0");
  }
  auto* module = find_module(bench, *address);
  if (module == nullptr) {
    return tl::unexpected(no_such_module(std::to_string(*address)));
  }
  if (*motor < 0 || *motor >= module->model().axes) {
    return tl::unexpected(std::string(module->model().name) + " has no motor " +
                          std::to_string(*motor));
  }
  return Motor{module, static_cast<std::size_t>(*motor)};
}

Outcome set_load(Motor motor, std::string_view word) {
  const auto load = number_in(word);
  if (!load || *load < 0 || *load > most_load) {
    return tl::unexpected(quoted(word) + " is not a load: they are 0 to " +
                          std::to_string(most_load) + ", in 1/1000 of what it can drive");
  }
  motor.module->at_stage(motor.number, [&](sim::Stage& stage) { stage.set_load(*load); });
  return {};
}

Outcome slip(Motor motor, std::string_view word) {
  const auto counts = number_in(word);
  if (!counts) return tl::unexpected(quoted(word) + " is not a number of encoder counts");
  if (!motor.module->stage(motor.number).settings().encoder) {
    return tl::unexpected(std::string("this motor has no encoder"));
  }
  motor.module->at_stage(motor.number, [&](sim::Stage& stage) { stage.slip(*counts); });
  return {};
}

Outcome set_switch(Motor motor, std::string_view word, bool pressed) {
  const auto found = std::ranges::find(switch_names, word);
  if (found == switch_names.end()) {
    return tl::unexpected(quoted(word) + " is not a switch: they are left, right and home." +
                          tmcl::did_you_mean(word, switch_names));
  }
  const auto which = static_cast<sim::StageSwitch>(found - switch_names.begin());
  motor.module->at_stage(motor.number, [&](sim::Stage& stage) { stage.press(which, pressed); });
  return {};
}

Outcome set_fault(Motor motor, std::string_view name, std::string_view level) {
  const auto fault = parse_driver_fault(name);
  if (!fault) {
    return tl::unexpected(quoted(name) + " is nothing that can be wrong with a driver." +
                          tmcl::did_you_mean(name, driver_fault_names));
  }
  if (level != "on" && level != "off") return tl::unexpected(quoted(level) + " is not on or off");
  motor.module->at_stage(motor.number,
                         [&](sim::Stage& stage) { stage.set_fault(*fault, level == "on"); });
  return {};
}

Outcome press(Motor motor, std::string_view word) { return set_switch(motor, word, true); }

Outcome release(Motor motor, std::string_view word) { return set_switch(motor, word, false); }

Outcome set_input(sim::Module& module, std::uint8_t port, std::int32_t level) {
  if (level != 0 && level != 1) return tl::unexpected(std::string("an input is 0 or 1"));
  if (!module.set_input(port, level == 1)) {
    return tl::unexpected(std::string(module.model().name) + " has no digital input " +
                          std::to_string(port));
  }
  return {};
}

Outcome set_analog(sim::Module& module, std::uint8_t port, std::int32_t value) {
  if (value < 0 || value > sim::Io::greatest_analog) {
    return tl::unexpected("an analogue input is 0 to " + std::to_string(sim::Io::greatest_analog));
  }
  if (!module.set_analog(port, value)) {
    return tl::unexpected(std::string(module.model().name) + " has no analogue input " +
                          std::to_string(port));
  }
  return {};
}

Outcome shut_down(sim::Module& module, std::string_view word) {
  if (word != "0" && word != "1") return tl::unexpected(std::string("an input is 0 or 1"));
  if (!module.set_shutdown_input(word == "1")) {
    return tl::unexpected(std::string(module.model().name) + " has no shutdown input");
  }
  return {};
}

Outcome set_supply(sim::Module& module, std::string_view word) {
  const auto tenths = parse_supply(word);
  if (!tenths) return tl::unexpected(quoted(word) + " is no voltage, such as 24 or 23.5, nor usb");
  module.set_supply(*tenths);
  return {};
}

Outcome brown_out(sim::Module& module, std::string_view word) {
  constexpr std::int32_t longest = 3'600'000;
  const auto time = number_in(word);
  if (!time || *time < 1 || *time > longest)
    return tl::unexpected(quoted(word) + " is no time: it is 1 to 3600000 ms");
  module.brown_out(std::chrono::milliseconds(*time));
  return {};
}

Outcome set_temperature(sim::Module& module, std::string_view word) {
  const auto degrees = number_in(word);
  const bool is_set = degrees && module.set_analog(sim::Io::temperature_port, *degrees);
  if (!is_set) return tl::unexpected(quoted(word) + " is no temperature in deg C from 0 on");
  return {};
}

Outcome set_power(sim::Module& module, std::string_view word) {
  if (word == "off") {
    module.power_off();
  } else if (word == "cycle" || (word == "on" && !module.hears())) {
    module.power_cycle();
  } else if (word != "on") {
    return tl::unexpected(quoted(word) + " is not off, on or cycle");
  }
  return {};
}

Outcome at_module(sim::Bench& bench, const Words& words,
                  Outcome (*change)(sim::Module& module, std::string_view word)) {
  const auto address = number_in(words[1]);
  auto* module = address ? find_module(bench, *address) : nullptr;
  if (module == nullptr) return tl::unexpected(no_such_module(words[1]));
  return change(*module, words[2]);
}

Outcome at_motor(sim::Bench& bench, const Words& words,
                 Outcome (*change)(Motor motor, std::string_view operand)) {
  const auto motor = find_motor(bench, words[1]);
  if (!motor) return tl::unexpected(motor.error());
  return change(*motor, words[2]);
}

Outcome at_driver(sim::Bench& bench, const Words& words) {
  const auto motor = find_motor(bench, words[1]);
  if (!motor) return tl::unexpected(motor.error());
  return set_fault(*motor, words[2], words[3]);
}

Outcome at_port(sim::Bench& bench, const Words& words,
                Outcome (*change)(sim::Module& module, std::uint8_t port, std::int32_t value)) {
  const auto address = number_in(words[1]);
  auto* module = address ? find_module(bench, *address) : nullptr;
  if (module == nullptr) return tl::unexpected(no_such_module(words[1]));
  const auto port = number_in(words[2]);
  if (!port || *port < 0 || *port > UINT8_MAX) {
    return tl::unexpected(quoted(words[2]) + " is not a port");
  }
  const auto value = number_in(words[3]);
  if (!value) return tl::unexpected(quoted(words[3]) + " is not a number");
  return change(*module, static_cast<std::uint8_t>(*port), *value);
}

struct ConsoleCommand {
  std::string_view name;
  std::string_view usage;
  std::size_t words;
  Outcome (*run)(sim::Bench& bench, const Words& words);
};

constexpr auto commands = std::to_array<ConsoleCommand>({
    {"load", "load ADDRESS/MOTOR LOAD", 3,
     [](auto& bench, const auto& words) { return at_motor(bench, words, set_load); }},
    {"slip", "slip ADDRESS/MOTOR COUNTS", 3,
     [](auto& bench, const auto& words) { return at_motor(bench, words, slip); }},
    {"press", "press ADDRESS/MOTOR left|right|home", 3,
     [](auto& bench, const auto& words) { return at_motor(bench, words, press); }},
    {"release", "release ADDRESS/MOTOR left|right|home", 3,
     [](auto& bench, const auto& words) { return at_motor(bench, words, release); }},
    {"input", "input ADDRESS PORT 0|1", 4,
     [](auto& bench, const auto& words) { return at_port(bench, words, set_input); }},
    {"shutdown", "shutdown ADDRESS 0|1", 3,
     [](auto& bench, const auto& words) { return at_module(bench, words, shut_down); }},
    {"driver", "driver ADDRESS/MOTOR FAULT on|off", 4, at_driver},
    {"supply", "supply ADDRESS VOLTS|usb", 3,
     [](auto& bench, const auto& words) { return at_module(bench, words, set_supply); }},
    {"brown_out", "brown_out ADDRESS MILLISECONDS", 3,
     [](auto& bench, const auto& words) { return at_module(bench, words, brown_out); }},
    {"temperature", "temperature ADDRESS DEGREES", 3,
     [](auto& bench, const auto& words) { return at_module(bench, words, set_temperature); }},
    {"power", "power ADDRESS off|on|cycle", 3,
     [](auto& bench, const auto& words) { return at_module(bench, words, set_power); }},
    {"analog", "analog ADDRESS PORT VALUE", 4,
     [](auto& bench, const auto& words) { return at_port(bench, words, set_analog); }},
});

std::string no_such_command(std::string_view word) {
  std::vector<std::string_view> names;
  std::string list;
  for (const auto& command : commands) {
    names.push_back(command.name);
    list += (list.empty() ? "" : ", ") + std::string(command.name);
  }
  return quoted(word) + " is not one of " + list + "." + tmcl::did_you_mean(word, names);
}

Outcome run(sim::Bench& bench, const Words& words) {
  const auto command = std::ranges::find(commands, words[0], &ConsoleCommand::name);
  if (command == commands.end()) return tl::unexpected(no_such_command(words[0]));
  if (words.size() != command->words)
    return tl::unexpected("it is: " + std::string(command->usage));
  return command->run(bench, words);
}

}  // namespace

std::string run_console_line(sim::Bench& bench, std::string_view line) {
  const auto words = tmcl::words_in(line);
  if (words.empty()) return "";
  const auto outcome = run(bench, words);
  return outcome ? "ok" : "error: " + outcome.error();
}

}  // namespace tmclsim
