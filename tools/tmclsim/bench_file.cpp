#include "bench_file.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "motor_words.hpp"
#include "settings_words.hpp"
#include "sim/module/delivered_stage.hpp"
#include "tmcl/model.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/spelling.hpp"

namespace tmclsim {
namespace {

using tmcl::quoted;
using tmcl::sim::EncoderSettings;
using tmcl::sim::Interval;
using tmcl::sim::ModuleSettings;
using tmcl::sim::Place;
using tmcl::sim::StageSettings;

constexpr std::int64_t greatest_address = 255;
// So far that no motor gets there, and near enough to count on.
constexpr std::int64_t greatest_place = std::int64_t{1} << 50;
constexpr std::int64_t greatest_count = 1 << 24;
constexpr std::int64_t greatest_load = 1'000'000;
constexpr std::int64_t greatest_speed = 1'000'000'000;
constexpr double greatest_supply = 1000;  // in volts
constexpr std::int64_t greatest_temperature = 1000;
constexpr std::int64_t greatest_answer_us = 1'000'000;

constexpr auto file_keys = std::to_array<std::string_view>({"module"});
constexpr auto own_module_keys =
    std::to_array<std::string_view>({"model", "address", "as", "firmware_version", "behaviour",
                                     "answer_us", "data_logger", "supply", "temperature", "axis"});
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
                                                            "inertia",
                                                            "corner_speed",
                                                            "pull_in_speed",
                                                            "torque_follows_current",
                                                            "driver_faults"});

struct Range {
  std::int64_t least;
  std::int64_t most;
};
constexpr Range places{-greatest_place, greatest_place};

// Thrown within this file only: the way out of nested tables.
struct Wrong {
  toml::source_position where;
  std::string sentence;
};

[[noreturn]] void complain(const toml::node& node, std::string sentence) {
  throw Wrong{node.source().begin, std::move(sentence)};
}

void want_known_keys(const toml::table& table, std::span<const std::string_view> known) {
  for (const auto& [key, node] : table) {
    if (std::ranges::find(known, key.str()) != known.end()) continue;
    throw Wrong{key.source().begin, "there is no key " + quoted(key.str()) + "." +
                                        tmcl::did_you_mean(key.str(), known)};
  }
}

std::int64_t number(const toml::node& node, std::string_view key, Range range) {
  const auto* integer = node.as_integer();
  if (integer == nullptr) complain(node, quoted(key) + " must be a whole number");
  const auto value = integer->get();
  if (value < range.least || value > range.most) {
    complain(node, quoted(key) + " is " + std::to_string(value) + ", but must be " +
                       std::to_string(range.least) + " to " + std::to_string(range.most));
  }
  return value;
}

std::optional<std::int64_t> number(const toml::table& table, std::string_view key, Range range) {
  const auto* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  return number(*node, key, range);
}

template <class Integer>
void take(const toml::table& table, std::string_view key, Range range, Integer& target) {
  if (const auto value = number(table, key, range)) target = static_cast<Integer>(*value);
}

void take(const toml::table& table, std::string_view key, std::optional<Place>& target) {
  if (const auto value = number(table, key, places)) target = *value;
}

void take_speed(const toml::table& table, std::string_view key, std::int64_t least,
                std::optional<std::int32_t>& target) {
  if (const auto value = number(table, key, {least, greatest_speed}))
    target = static_cast<std::int32_t>(*value);
}

void take(const toml::table& table, std::string_view key, bool& target) {
  const auto* node = table.get(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) complain(*node, quoted(key) + " must be true or false");
  target = node->as_boolean()->get();
}

void take(const toml::table& table, std::string_view key, std::optional<bool>& target) {
  if (table.get(key) == nullptr) return;
  target.emplace();
  take(table, key, *target);
}

// And the names of the traits.
std::vector<std::string_view> module_keys() {
  std::vector<std::string_view> keys(own_module_keys.begin(), own_module_keys.end());
  for (const auto& info : tmcl::trait_table()) keys.push_back(info.name);
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

StageSettings stage_of(const toml::table& table, StageSettings stage) {
  take(table, "position", places, stage.position);
  take(table, "left_switch", stage.left_switch);
  take(table, "right_switch", stage.right_switch);
  take(table, "switch_tolerance", {0, greatest_place}, stage.switch_tolerance);
  take(table, "normally_closed", stage.limits_normally_closed);
  take_home(table, stage.home);
  take(table, "home_normally_closed", stage.home_normally_closed);
  take(table, "left_stop", stage.left_stop);
  take(table, "right_stop", stage.right_stop);
  take_encoder(table, stage.encoder);
  take(table, "full_steps_per_turn", {1, greatest_count}, stage.full_steps_per_turn);
  take(table, "load", {0, greatest_load}, stage.load);
  take(table, "load_per_velocity", {0, greatest_load}, stage.load_per_velocity);
  take(table, "inertia", {0, greatest_load}, stage.inertia);
  take_speed(table, "corner_speed", 1, stage.corner_speed);
  take_speed(table, "pull_in_speed", 0, stage.pull_in_speed);
  take(table, "torque_follows_current", stage.torque_follows_current);
  take_faults(table, stage.faults);
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

const tmcl::Model& model_of(const toml::table& table) {
  const auto* node = table.get("model");
  if (node == nullptr) complain(table, "this module has no 'model'");
  const auto* name = node->as_string();
  if (name == nullptr) complain(*node, "'model' must be a name, such as \"TMCM-1110\"");
  const auto* model = tmcl::find_model(name->get());
  if (model != nullptr) return *model;
  std::vector<std::string_view> names;
  for (const auto& known : tmcl::models()) names.push_back(known.name);
  complain(*node, "there is no module " + quoted(name->get()) + "." +
                      tmcl::did_you_mean(name->get(), names));
}

std::string word(const toml::node& node, std::string_view key, std::string_view example) {
  const auto* text = node.as_string();
  if (text != nullptr) return text->get();
  complain(node,
           quoted(key) + " must be a text in quotes, such as \"" + std::string(example) + "\"");
}

template <class Value>
void take_word(const toml::table& table, std::string_view key,
               tl::expected<Value, std::string> (*parse)(std::string_view), Value& target) {
  const auto* node = table.get(key);
  if (node == nullptr) return;
  const auto value = parse(word(*node, key, "manual"));
  if (!value) complain(*node, quoted(key) + " " + value.error());
  target = *value;
}

void take_traits(const toml::table& table, const tmcl::Model& model, tmcl::ModuleTraits& traits) {
  for (const auto& info : tmcl::trait_table()) {
    const auto* node = table.get(info.name);
    if (node == nullptr) continue;
    const auto variant = tmcl::parse_variant(info, word(*node, info.name, info.variants[0]));
    if (!variant) complain(*node, quoted(info.name) + " " + variant.error());
    // The first is what a module does that has no choice.
    if (*variant != 0 && !tmcl::concerns(info.trait, model))
      complain(*node, "a " + std::string(model.name) + " has no TMC429: " + quoted(info.name) +
                          " can only be " + std::string(info.variants[0]));
    traits.set(info.trait, *variant);
  }
}

ModuleSettings settings_of(const toml::table& table, const tmcl::Model& model) {
  ModuleSettings settings;
  if (const auto* node = table.get("as")) {
    const auto measured = settings_as(word(*node, "as", "module.toml"), model);
    if (!measured) complain(*node, measured.error());
    settings = *measured;
  }
  if (const auto* node = table.get("firmware_version")) {
    const auto text = word(*node, "firmware_version", "1.09");
    settings.firmware = parse_release(text);
    if (!settings.firmware) complain(*node, quoted(text) + std::string(no_release));
  }
  take_word(table, "behaviour", parse_behaviour, settings.behaviour);
  take_traits(table, model, settings.traits);
  if (const auto us = number(table, "answer_us", {0, greatest_answer_us}))
    settings.to_answer = std::chrono::microseconds(*us);
  take(table, "data_logger", settings.data_logger);
  return settings;
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

std::string sentence_at(std::string_view name, toml::source_position where,
                        std::string_view sentence) {
  return std::string(name) + ":" + std::to_string(where.line) + ": " + std::string(sentence);
}

}  // namespace

BenchFile parse_bench_file(std::string_view text, std::string_view name) try {
  const auto file = toml::parse(text);
  want_known_keys(file, file_keys);
  std::vector<BenchModule> modules;
  for (const auto* table : tables(file, "module")) modules.push_back(module_of(*table));
  return modules;
} catch (const toml::parse_error& error) {
  return tl::unexpected(sentence_at(name, error.source().begin, error.description()));
} catch (const Wrong& wrong) {
  return tl::unexpected(sentence_at(name, wrong.where, wrong.sentence));
}

BenchFile read_bench_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    return tl::unexpected(path + ": cannot be read, or is empty");
  }
  return parse_bench_file(text.str(), path);
}

}  // namespace tmclsim
