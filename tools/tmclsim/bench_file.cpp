#include "bench_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "config/module_keys.hpp"
#include "config/toml_reading.hpp"
#include "firmware_keys.hpp"
#include "motor_words.hpp"
#include "sim/module/delivered_stage.hpp"
#include "tmcl/model.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/spelling.hpp"

namespace tmclsim {

using namespace tmcld;  // how TOML is read

namespace {

using tmcl::sim::EncoderSettings;
using tmcl::sim::Interval;
using tmcl::sim::Place;
using tmcl::sim::StageSettings;

constexpr std::int64_t greatest_address = 255;
// So far that no motor gets there, and near enough to count on.
constexpr std::int64_t greatest_place = std::int64_t{1} << 50;
constexpr std::int64_t greatest_count = 1 << 24;
constexpr std::int64_t greatest_load = 1'000'000;
constexpr std::int64_t greatest_load_value = 1023;
constexpr std::int64_t greatest_speed = 1'000'000'000;
constexpr double greatest_supply = 1000;  // in volts
constexpr double least_resonance_hz = 0.01;
constexpr double greatest_resonance_hz = 1000;
constexpr double greatest_damping = 0.999;
constexpr std::int64_t greatest_temperature = 1000;

constexpr auto file_keys = std::to_array<std::string_view>({"module"});
constexpr auto axis_keys = std::to_array<std::string_view>({"motor",
                                                            "position",
                                                            "left_switch",
                                                            "right_switch",
                                                            "switch_tolerance",
                                                            "normally_closed",
                                                            "home",
                                                            "home_normally_closed",
                                                            "left_stop",
                                                            "right_stop",
                                                            "encoder_counts_per_turn",
                                                            "encoder_sign",
                                                            "full_steps_per_turn",
                                                            "load",
                                                            "load_per_velocity",
                                                            "pull",
                                                            "inertia",
                                                            "corner_speed",
                                                            "pull_in_speed",
                                                            "torque_follows_current",
                                                            "load_value_slope",
                                                            "load_value_noise",
                                                            "backlash",
                                                            "driver_faults",
                                                            "resonance",
                                                            "damping"});

constexpr Range places{-greatest_place, greatest_place};

void take_place(const toml::table& table, std::string_view key, std::optional<Place>& target) {
  if (const auto value = number(table, key, places)) target = *value;
}

void take_speed(const toml::table& table, std::string_view key, std::int64_t least,
                std::optional<std::int32_t>& target) {
  if (const auto value = number(table, key, {least, greatest_speed}))
    target = static_cast<std::int32_t>(*value);
}

std::vector<std::string_view> module_keys() {
  auto keys = measured_keys();
  for (const auto* key : {"as", "address", "supply", "temperature", "axis"}) keys.push_back(key);
  return keys;
}

void take_home(const toml::table& table, std::optional<Interval>& home) {
  const auto* node = table.get("home");
  if (node == nullptr) return;
  const auto* ends = node->as_array();
  if (ends == nullptr || ends->size() != 2) {
    complain(*node, "'home' must be the places where the switch begins and ends: [-50, 50]");
  }
  home = Interval{number(*ends->get(0), "home", places), number(*ends->get(1), "home", places)};
  if (home->from > home->to) complain(*node, "'home' ends before it begins");
}

void take_encoder(const toml::table& table, std::optional<EncoderSettings>& encoder) {
  const auto* sign = table.get("encoder_sign");
  const auto counts = number(table, "encoder_counts_per_turn", {1, greatest_count});
  if (!counts && sign != nullptr) {
    complain(*sign, "'encoder_sign' goes with 'encoder_counts_per_turn'");
  }
  if (!counts) return;
  encoder = EncoderSettings{static_cast<std::int32_t>(*counts), false};
  if (sign == nullptr) return;
  const auto value = number(*sign, "encoder_sign", {-1, 1});
  if (value == 0) complain(*sign, "'encoder_sign' is 1 or -1");
  encoder->backwards = value < 0;
}

void take_faults(const toml::table& table, tmcl::sim::DriverFaults& faults) {
  const auto* node = table.get("driver_faults");
  if (node == nullptr) return;
  const auto* names = node->as_array();
  if (names == nullptr) complain(*node, "'driver_faults' must be a list: [\"open_load_a\"]");
  for (const auto& element : *names) {
    const auto name = element.value_or<std::string_view>("");
    const auto fault = parse_driver_fault(name);
    if (!fault) {
      complain(element, quoted(name) + " is nothing that can be wrong with a driver." +
                            tmcl::did_you_mean(name, driver_fault_names));
    }
    faults.set(*fault, true);
  }
}

double fraction(const toml::node& node, std::string_view key, double least, double greatest) {
  const auto value = node.value<double>();
  if (value && *value >= least && *value <= greatest) return *value;
  complain(node, quoted(key) + " must be " + tmcl::plain_number(least, 3) + " to " +
                     tmcl::plain_number(greatest, 4));
}

void take_resonance(const toml::table& table, StageSettings& stage) {
  const auto* frequency = table.get("resonance");
  const auto* damping = table.get("damping");
  if (frequency == nullptr && damping != nullptr)
    complain(*damping, "'damping' goes with 'resonance'");
  if (frequency == nullptr) return;
  if (!stage.encoder) complain(*frequency, "'resonance' is seen by an encoder, and there is none");
  stage.resonance.emplace();
  stage.resonance->damping = tmcl::ramp::usual_load_damping;
  stage.resonance->frequency_hz =
      fraction(*frequency, "resonance", least_resonance_hz, greatest_resonance_hz);
  if (damping != nullptr)
    stage.resonance->damping = fraction(*damping, "damping", 0, greatest_damping);
}

StageSettings stage_of(const toml::table& table, StageSettings stage) {
  take(table, "position", places, stage.position);
  take_place(table, "left_switch", stage.left_switch);
  take_place(table, "right_switch", stage.right_switch);
  take(table, "switch_tolerance", {0, greatest_place}, stage.switch_tolerance);
  take(table, "normally_closed", stage.limits_normally_closed);
  take_home(table, stage.home);
  take(table, "home_normally_closed", stage.home_normally_closed);
  take_place(table, "left_stop", stage.left_stop);
  take_place(table, "right_stop", stage.right_stop);
  take_encoder(table, stage.encoder);
  take(table, "full_steps_per_turn", {1, greatest_count}, stage.full_steps_per_turn);
  take(table, "load", {0, greatest_load}, stage.load);
  take(table, "load_per_velocity", {0, greatest_load}, stage.load_per_velocity);
  take(table, "pull", {-greatest_load, greatest_load}, stage.pull);
  take(table, "inertia", {0, greatest_load}, stage.inertia);
  take_speed(table, "corner_speed", 1, stage.corner_speed);
  take_speed(table, "pull_in_speed", 0, stage.pull_in_speed);
  take(table, "torque_follows_current", stage.torque_follows_current);
  take(table, "load_value_slope", {0, greatest_load}, stage.load_value_slope);
  take(table, "load_value_noise", {0, greatest_load_value}, stage.load_value_noise);
  take(table, "backlash", {0, greatest_place}, stage.backlash);
  take_faults(table, stage.faults);
  take_resonance(table, stage);
  if (stage.left_stop && stage.right_stop && *stage.left_stop > *stage.right_stop) {
    complain(*table.get("left_stop"), "'left_stop' is to the right of 'right_stop'");
  }
  return stage;
}

// The tables of [[key]].
std::vector<const toml::table*> tables(const toml::table& parent, std::string_view key) {
  std::vector<const toml::table*> found;
  const auto* node = parent.get(key);
  if (node == nullptr) return found;
  const auto* array = node->as_array();
  if (array == nullptr)
    complain(*node,
             quoted(key) + " must be written with two brackets: [[" + std::string(key) + "]]");
  for (const auto& element : *array) {
    if (!element.is_table()) complain(element, quoted(key) + " must consist of tables");
    found.push_back(element.as_table());
  }
  return found;
}

std::int32_t supply_of(const toml::node& node) {
  if (node.value<std::string_view>() == usb_supply_word) return usb_supply;
  const auto volts = node.value<double>();
  if (!volts || !(*volts >= 0 && *volts <= greatest_supply))
    complain(node, "'supply' must be 0 to 1000, in volts, such as 23.5, or \"usb\"");
  return static_cast<std::int32_t>(std::lround(*volts * 10));
}

Surroundings surroundings_of(const toml::table& table) {
  Surroundings surroundings;
  if (const auto* node = table.get("supply")) surroundings.supply_tenths = supply_of(*node);
  if (const auto degrees = number(table, "temperature", {0, greatest_temperature}))
    surroundings.temperature = static_cast<std::int32_t>(*degrees);
  return surroundings;
}

BenchModule module_of(const toml::table& table) {
  want_known_keys(table, module_keys());
  const auto& model = model_of(table);
  BenchModule module{std::string(model.name),
                     std::vector<StageSettings>(model.axes, tmcl::sim::delivered_stage(model)),
                     settings_of(table, model), surroundings_of(table)};
  if (const auto address = number(table, "address", {1, greatest_address})) {
    module.spec += "@" + std::to_string(*address);
  }
  std::vector<bool> taken(model.axes);
  for (const auto* axis : tables(table, "axis")) {
    want_known_keys(*axis, axis_keys);
    const auto given = number(*axis, "motor", {0, model.axes - 1});
    const auto motor = static_cast<std::size_t>(given.value_or(0));
    if (taken[motor]) complain(*axis, "motor " + std::to_string(motor) + " is described twice");
    taken[motor] = true;
    module.axes[motor] = stage_of(*axis, module.axes[motor]);
  }
  return module;
}

}  // namespace

tl::expected<std::vector<BenchModule>, std::string> parse_bench_file(std::string_view text,
                                                                     std::string_view name) {
  return parsed<std::vector<BenchModule>>(text, name, [](const toml::table& root) {
    want_known_keys(root, file_keys);
    std::vector<BenchModule> modules;
    for (const auto* table : tables(root, "module")) modules.push_back(module_of(*table));
    return modules;
  });
}

tl::expected<std::vector<BenchModule>, std::string> read_bench_file(const std::string& path) {
  const auto text = text_of_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse_bench_file(*text, path);
}

}  // namespace tmclsim
