#include "config/build.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

#include <grp.h>
#include <pwd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/feeding.hpp"
#include "config/module_file.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

constexpr std::size_t max_name_length = 32;
constexpr std::size_t max_socket_path_bytes = 107;  // sun_path, with its end
constexpr std::array<std::string_view, 4> level_names{"error", "warning", "info", "debug"};
constexpr std::array<std::string_view, 2> exit_names{"stop", "keep"};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// A name that starts with a letter and has no '/' can never be taken for ADDRESS/MOTOR.
bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= max_name_length && is_letter(text.front()) &&
         std::ranges::all_of(text, [](char c) {
           return is_letter(c) || is_digit(c) || c == '_' || c == '-' || c == '.';
         });
}

LinkScope scope_of(const tmcl::LinkName& link) {
  if (std::holds_alternative<tmcl::CanName>(link)) return LinkScope::can;
  if (std::holds_alternative<tmcl::TcpName>(link)) return LinkScope::tcp;
  return LinkScope::serial_framing;
}

/// Nothing if it is none.
std::optional<SentinelConfig> sentinel_of(std::string_view text) {
  using Kind = SentinelConfig::Kind;
  constexpr std::string_view variable = "variable:";
  if (text == "auto" || text == "tick") return SentinelConfig{Kind::tick};
  if (text == "settings") return SentinelConfig{Kind::settings};
  if (text == "none") return SentinelConfig{Kind::none};
  if (!text.starts_with(variable)) return std::nullopt;
  SentinelConfig sentinel{Kind::variable};
  const auto* end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + variable.size(), end, sentinel.variable);
  // The others can be kept in the EEPROM: they would be as they were after a restart.
  const bool is_good =
      read.ec == std::errc() && read.ptr == end && sentinel.variable >= tmcl::kept_user_variables;
  return is_good ? std::optional(sentinel) : std::nullopt;
}

std::optional<std::uint32_t> user_named(const std::string& name) {
  const auto* entry = ::getpwnam(name.c_str());
  return entry == nullptr ? std::nullopt : std::optional<std::uint32_t>(entry->pw_uid);
}

std::optional<std::uint32_t> group_named(const std::string& name) {
  const auto* entry = ::getgrnam(name.c_str());
  return entry == nullptr ? std::nullopt : std::optional<std::uint32_t>(entry->gr_gid);
}

bool applies(LinkScope key, LinkScope link) {
  return key == LinkScope::any || key == link ||
         (key == LinkScope::serial_framing && link == LinkScope::tcp);
}

/// The same for sections that say the same, wherever they stand.
std::string text_of(const ConfigSection& section) {
  auto text = fmt::format("{}\n", title_of(section.kind));
  for (const auto& [key, entry] : section.values) {
    const auto value =
        std::visit([](const auto& said) { return fmt::format("{}", said); }, entry.value);
    text += fmt::format("{} = {}\n", key, value);
  }
  return text;
}

std::string text_of(const decltype(PortConfig::place)& place) {
  if (const auto* pty = std::get_if<PtyName>(&place)) return "pty:" + pty->path;
  if (const auto* tcp = std::get_if<tmcl::TcpName>(&place)) return to_string(tmcl::LinkName(*tcp));
  return to_string(tmcl::LinkName(std::get<tmcl::CanName>(place)));
}

class Builder {
 public:
  explicit Builder(std::vector<ConfigProblem>& problems) : problems_(problems) {}

  Config build(std::span<const ConfigSection> sections) {
    for (const auto& section : sections) {
      const auto* name = section.get<std::string>("name");
      if (section.kind != SectionKind::bus) continue;
      if (name != nullptr) declared_buses_.push_back(*name);
      has_nameless_bus_ = has_nameless_bus_ || name == nullptr;
    }
    const auto each = [&](SectionKind kind, auto&& add) {
      for (const auto& section : sections) {
        if (section.kind == kind) add(section);
      }
    };
    each(SectionKind::daemon, [&](const auto& section) { add_daemon(section); });
    each(SectionKind::access, [&](const auto& section) { add_access(section); });
    each(SectionKind::bus, [&](const auto& section) { add_bus(section); });
    each(SectionKind::module, [&](const auto& section) { add_module(section); });
    each(SectionKind::axis, [&](const auto& section) { add_axis(section); });
    each(SectionKind::port, [&](const auto& section) { add_port(section); });
    for (const auto& section : sections) note_text(section);
    check_whole();
    return std::move(config_);
  }

 private:
  void complain(Place place, std::string message) {
    problems_.push_back({place, std::move(message)});
  }

  void note_text(const ConfigSection& section) {
    if (section.kind == SectionKind::daemon || section.kind == SectionKind::access) return;
    const bool is_bus = section.kind == SectionKind::bus;
    const bool is_on_bus = section.kind == SectionKind::module || section.kind == SectionKind::axis;
    const auto* name = section.get<std::string>(is_bus ? "name" : "bus");
    const auto bus = name == nullptr || !(is_bus || is_on_bus)
                         ? config_.buses.end()
                         : std::ranges::find(config_.buses, *name, &BusConfig::name);
    (bus == config_.buses.end() ? config_.others : bus->said) += text_of(section);
  }

  void add_daemon(const ConfigSection& section) {
    if (const auto* socket = section.get<std::string>("socket")) add_socket(section, *socket);
    set_choice(section, "log_level", level_names, config_.daemon.log_level);
    set_choice(section, "on_exit", exit_names, config_.daemon.on_exit);
    if (const auto* state = section.get<std::string>("state")) config_.daemon.state = *state;
    if (const auto* file = section.get<std::string>("audit")) config_.daemon.audit = *file;
    if (const auto* flag = section.get<bool>("moves_need_lease"))
      config_.daemon.moves_need_lease = *flag;
  }

  void add_access(const ConfigSection& section) {
    auto& access = config_.access.emplace_back();
    // A stop is not there to be given: everybody has it.
    auto given = static_cast<std::uint8_t>(0);
    set_choice(section, "role", std::span(role_names).subspan(1), given);
    access.role = static_cast<Role>(given + 1);
    add_accounts(section, "users", user_named, access.users);
    add_accounts(section, "groups", group_named, access.groups);
    if (section.find("users") != nullptr || section.find("groups") != nullptr) return;
    complain(section.place, "[[access]] needs 'users' or 'groups': who has the role");
  }

  void add_accounts(const ConfigSection& section, std::string_view key,
                    std::optional<std::uint32_t> (*find)(const std::string&),
                    std::vector<Account>& into) {
    const auto* names = section.get<ConfigTexts>(key);
    if (names == nullptr) return;
    for (const auto& name : *names) {
      const auto id = find(name);
      if (id) into.push_back({name, *id});
      if (id) continue;
      complain(section.place_of(key), fmt::format("there is no {} {} on this computer",
                                                  key == "users" ? "user" : "group", quoted(name)));
    }
  }

  /// One of the names of an enumeration, in its order.
  template <class Choice>
  void set_choice(const ConfigSection& section, std::string_view key,
                  std::span<const std::string_view> names, Choice& into) {
    const auto* said = section.get<std::string>(key);
    if (said == nullptr) return;
    const auto found = std::ranges::find(names, *said);
    if (found != names.end()) {
      into = static_cast<Choice>(found - names.begin());
      return;
    }
    complain(section.place_of(key), fmt::format("'{}' is '{}', but must be {} or {}.{}", key, *said,
                                                fmt::join(names.first(names.size() - 1), ", "),
                                                names.back(), tmcl::did_you_mean(*said, names)));
  }

  void add_socket(const ConfigSection& section, const std::string& path) {
    if (path.empty() || path.size() > max_socket_path_bytes) {
      complain(section.place_of("socket"),
               "'socket' must be a path of 1.." + std::to_string(max_socket_path_bytes) + " bytes");
    }
    config_.daemon.socket = path;
  }

  // Nothing if the name is missing, malformed or taken.
  template <class List>
  const std::string* new_name(const ConfigSection& section, const List& taken) {
    const auto* name = section.get<std::string>("name");
    if (name == nullptr) return nullptr;
    if (!is_name(*name)) {
      complain(section.place_of("name"),
               "the name " + quoted(*name) +
                   " must start with a letter and have at most 32 letters, digits, '_', '-', '.'");
      return nullptr;
    }
    if (std::ranges::any_of(taken, [&](const auto& other) { return other.name == *name; })) {
      complain(section.place_of("name"), "the name " + quoted(*name) + " is given twice in " +
                                             std::string(title_of(section.kind)));
      return nullptr;
    }
    return name;
  }

  void add_bus(const ConfigSection& section) {
    const auto* name = new_name(section, config_.buses);
    const auto* text = section.get<std::string>("link");
    if (text == nullptr) return;
    auto link = tmcl::parse_link_name(*text);
    if (!link) {
      const auto& error = link.error();
      return complain(section.place_of("link"),
                      error.message + (error.hint.empty() ? "" : ": " + error.hint));
    }
    check_scopes(section, *link);
    for (const auto& other : config_.buses) {
      if (to_string(other.link) != to_string(*link)) continue;
      complain(section.place_of("link"), "bus " + quoted(other.name) + " already uses this link");
    }
    if (name == nullptr) return;
    config_.buses.push_back({*name, std::move(*link), link_options(section), bus_options(section)});
    config_.buses.back().bus_options.name = *name;
  }

  void check_scopes(const ConfigSection& section, const tmcl::LinkName& link) {
    for (const auto& [key, value] : section.values) {
      const auto* row = find_key(section.kind, key);
      if (applies(row->scope, scope_of(link))) continue;
      complain(value.place, quoted(key) + " means nothing here: it is for " +
                                std::string(name_of(row->scope)) + " links");
    }
  }

  template <class T>
  static void set(const ConfigSection& section, std::string_view key, T& target) {
    if (const auto* value = section.get<std::int64_t>(key)) target = static_cast<T>(*value);
  }
  static void set(const ConfigSection& section, std::string_view key, tmcl::Duration& target) {
    if (const auto* value = section.get<std::int64_t>(key)) {
      target = std::chrono::milliseconds(*value);
    }
  }

  static tmcl::LinkOptions link_options(const ConfigSection& section) {
    tmcl::LinkOptions options;
    set(section, "can_reply_id", options.can_reply_id);
    set(section, "connect_timeout_ms", options.connect_timeout);
    if (const auto* flag = section.get<bool>("can_extended")) options.can_extended = *flag;
    return options;
  }

  static tmcl::BusOptions bus_options(const ConfigSection& section) {
    tmcl::BusOptions options;
    set(section, "reply_timeout_ms", options.reply_timeout);
    set(section, "telegram_pause_ms", options.telegram_pause);
    set(section, "quiet_time_ms", options.quiet_time);
    set(section, "silence_time_ms", options.silence_time);
    set(section, "attempts", options.attempts);
    set(section, "host_address", options.host_address);
    return options;
  }

  void add_module(const ConfigSection& section) {
    const auto* bus_name = section.get<std::string>("bus");
    const auto* number = section.get<std::int64_t>("address");
    const auto* named = bus_name == nullptr ? nullptr : find_bus(section, *bus_name);
    if (named == nullptr || number == nullptr) return;
    auto& modules = std::ranges::find(config_.buses, *bus_name, &BusConfig::name)->modules;
    const tmcl::ModuleAddress address{static_cast<std::uint16_t>(*number)};
    if (std::ranges::count(modules, address, &ModuleConfig::address) != 0) {
      complain(section.place_of("address"), "module " + std::to_string(*number) + " on bus " +
                                                quoted(*bus_name) + " is given twice");
    }
    modules.push_back({address});
    add_deadman(section, *std::ranges::find(config_.buses, *bus_name, &BusConfig::name));
    add_measured(section, modules.back());
    const auto* text = section.get<std::string>("sentinel");
    if (text == nullptr) return;
    const auto sentinel = sentinel_of(*text);
    if (sentinel) modules.back().sentinel = *sentinel;
    if (sentinel) return;
    complain(section.place_of("sentinel"),
             "'sentinel' is " + quoted(*text) +
                 ", but must be auto, tick, settings, none or variable:N with N from 56 to 255");
  }

  void add_measured(const ConfigSection& section, ModuleConfig& module) {
    const auto* path = section.get<std::string>("as");
    if (path == nullptr) return;
    auto measured = read_measured_module(*path);
    if (!measured) return complain(section.place_of("as"), "'as': " + measured.error());
    module.as = *measured;
  }

  /// Of the module that was added last.
  void add_deadman(const ConfigSection& section, BusConfig& bus) {
    const auto* ms = section.get<std::int64_t>("deadman_ms");
    if (ms == nullptr) return;
    bus.modules.back().deadman_ms = static_cast<std::int32_t>(*ms);
    auto fault = fault_of_deadman(*bus.modules.back().deadman_ms);
    if (fault.empty()) fault = fault_of_feeding(bus);
    if (!fault.empty()) complain(section.place_of("deadman_ms"), "'deadman_ms' " + fault);
  }

  void add_axis(const ConfigSection& section) {
    const auto* name = new_name(section, config_.axes);
    const auto* bus_name = section.get<std::string>("bus");
    const auto* address = section.get<std::int64_t>("address");
    const auto* motor = section.get<std::int64_t>("motor");
    const auto* bus = bus_name == nullptr ? nullptr : find_bus(section, *bus_name);
    if (bus == nullptr || address == nullptr || motor == nullptr) return;
    if (*address > 255 && scope_of(bus->link) != LinkScope::can) {
      return complain(section.place_of("address"),
                      "'address' is " + std::to_string(*address) + ", but bus " +
                          quoted(bus->name) +
                          " is no CAN bus: modules there have addresses 0..255");
    }
    check_reply_id(section, *bus, *address);
    const tmcl::AxisAddress where{tmcl::ModuleAddress{static_cast<std::uint16_t>(*address)},
                                  static_cast<std::uint8_t>(*motor)};
    for (const auto& other : config_.axes) {
      if (other.bus != *bus_name || other.address != where) continue;
      complain(section.place_of("motor"),
               "axis " + quoted(other.name) + " already is motor " + std::to_string(*motor) +
                   " of module " + std::to_string(*address) + " on bus " + quoted(*bus_name));
    }
    auto scale = scale_of(section);
    const bool needs_reference = reference_is_required(section);
    const auto limits = motion_limits_of(section);
    if (name != nullptr)
      config_.axes.push_back({*name, *bus_name, where, std::move(scale), needs_reference, limits});
  }

  MotionLimits motion_limits_of(const ConfigSection& section) {
    MotionLimits limits;
    const auto set_limit = [&](std::string_view key, std::optional<double>& limit) {
      if (section.find(key) != nullptr) set_positive(section, key, "", limit.emplace());
    };
    set_limit("max_velocity", limits.velocity);
    set_limit("max_acceleration", limits.acceleration);
    set_limit("max_deceleration", limits.deceleration);
    set_limit("max_jerk", limits.jerk);
    set_limit("max_corner_jump", limits.corner_jump);
    if (const auto* current = section.get<std::int64_t>("max_current"))
      limits.current = static_cast<std::int32_t>(*current);
    return limits;
  }

  bool reference_is_required(const ConfigSection& section) {
    const auto* text = section.get<std::string>("reference");
    if (text == nullptr || *text == "optional") return false;
    if (*text == "required") return true;
    complain(section.place_of("reference"),
             "'reference' is " + quoted(*text) + ", but must be required or optional");
    return false;
  }

  void check_reply_id(const ConfigSection& section, const BusConfig& bus, std::int64_t address) {
    const auto reply_id = bus.link_options.can_reply_id;
    if (scope_of(bus.link) != LinkScope::can || address != reply_id) return;
    // Its other motors have been told of it.
    const bool told = std::ranges::any_of(config_.axes, [&](const auto& other) {
      return other.bus == bus.name && number(other.address.module) == address;
    });
    if (told) return;
    const auto* name = section.get<std::string>("name");
    complain(section.place_of("address"),
             fmt::format("{} has the address {}, but replies on bus '{}' come with the identifier "
                         "{}: its module would take every reply for a command, and move. Give the "
                         "module another address (global parameter 71), or all modules of the bus "
                         "another reply identifier (70) and say so with 'can_reply_id'",
                         name == nullptr ? "this axis" : "axis " + quoted(*name), address, bus.name,
                         reply_id));
  }

  ScaleConfig scale_of(const ConfigSection& section) {
    ScaleConfig scale;
    set(section, "full_steps", scale.full_steps);
    if (const auto* flag = section.get<bool>("reverse")) scale.reverse = *flag;
    if (const auto* microsteps = section.get<std::int64_t>("microsteps")) {
      const auto count = static_cast<std::uint64_t>(*microsteps);
      if (!std::has_single_bit(count)) {
        complain(section.place_of("microsteps"),
                 "'microsteps' is " + std::to_string(count) + ", but must be a power of two");
      }
      scale.microstep_resolution = std::countr_zero(count);
    }
    add_unit(section, scale);
    return scale;
  }

  void add_unit(const ConfigSection& section, ScaleConfig& scale) {
    const auto* unit = section.get<std::string>("unit");
    const auto distance_key = distance_key_of(section);
    const bool has_distance = section.find(distance_key) != nullptr;
    if ((unit == nullptr) == has_distance) {
      return complain(section.place_of(has_distance ? distance_key : "unit"),
                      "'unit' and 'units_per_revolution' (or 'screw_pitch') belong together: what "
                      "positions are measured in, and how much of it a turn is");
    }
    add_limits(section, scale);
    if (unit == nullptr) return complain_without_unit(section);
    if (const auto fault = tmcl::fault_of_unit_name(*unit); !fault.empty())
      complain(section.place_of("unit"), "the unit " + quoted(*unit) + " " + fault);
    scale.unit = *unit;
    constexpr std::string_view other_direction = "; for the other direction say reverse = true";
    set_positive(section, distance_key, other_direction, scale.units_per_revolution);
    set_positive(section, "gear_ratio", other_direction, scale.gear_ratio);
    add_encoder(section, scale);
  }

  std::string_view distance_key_of(const ConfigSection& section) {
    const bool pitch = section.find("screw_pitch") != nullptr;
    if (pitch && section.find("units_per_revolution") != nullptr) {
      complain(section.place_of("screw_pitch"),
               "'screw_pitch' and 'units_per_revolution' both say how much a turn is: give one");
    }
    return pitch ? "screw_pitch" : "units_per_revolution";
  }

  void complain_without_unit(const ConfigSection& section) {
    for (const std::string_view key :
         {"gear_ratio", "encoder_lines", "encoder_quadrature", "encoder_counts_per_unit"}) {
      if (section.find(key) == nullptr) continue;
      complain(section.place_of(key), quoted(key) + " means nothing without 'unit'");
    }
  }

  void set_positive(const ConfigSection& section, std::string_view key, std::string_view advice,
                    double& target) {
    const auto* value = section.get<double>(key);
    if (value == nullptr) return;
    target = *value;
    if (*value > 0 && std::isfinite(*value)) return;
    complain(section.place_of(key),
             fmt::format("'{}' is {}, but must be greater than 0{}", key, *value, advice));
  }

  void add_limits(const ConfigSection& section, ScaleConfig& scale) {
    const auto* limits = section.get<ConfigRange>("soft_limits");
    if (limits == nullptr) return;
    const auto [least, greatest] = *limits;
    if (!(least < greatest) || !std::isfinite(least) || !std::isfinite(greatest)) {
      complain(section.place_of("soft_limits"),
               fmt::format("'soft_limits' is [{}, {}], but the first must be less than the second",
                           least, greatest));
    }
    scale.limits = tmcl::SoftLimits{{least}, {greatest}};
  }

  void add_encoder(const ConfigSection& section, ScaleConfig& scale) {
    const auto* lines = section.get<std::int64_t>("encoder_lines");
    const auto* quadrature = section.get<bool>("encoder_quadrature");
    const bool linear = section.find("encoder_counts_per_unit") != nullptr;
    if (linear && lines != nullptr) {
      complain(section.place_of("encoder_counts_per_unit"),
               "'encoder_counts_per_unit' is for a linear encoder and 'encoder_lines' for one on "
               "the motor's shaft: give one");
    }
    if (quadrature != nullptr && lines == nullptr) {
      complain(section.place_of("encoder_quadrature"),
               "'encoder_quadrature' means nothing without 'encoder_lines'");
    }
    if (linear)
      set_positive(section, "encoder_counts_per_unit", "", scale.encoder_counts_per_unit.emplace());
    if (lines == nullptr || linear) return;
    const tmcl::ShaftEncoder encoder{static_cast<std::int32_t>(*lines),
                                     quadrature == nullptr || *quadrature};
    scale.encoder_counts_per_unit = counts_per_unit(encoder, scale.with_resolution(0));
  }

  void add_port(const ConfigSection& section) {
    const auto* name = new_name(section, config_.ports);
    const auto* bus_name = section.get<std::string>("bus");
    const auto role = role_of_port(section);
    const auto place = place_of_port(section);
    const auto* bus = bus_name == nullptr ? nullptr : find_bus(section, *bus_name);
    if (bus == nullptr || name == nullptr || !place) return;
    config_.ports.push_back({*name, *bus_name, *place, role});
  }

  Role role_of_port(const ConfigSection& section) {
    constexpr std::array<std::string_view, 2> words{"move", "configure"};
    auto role = Role::observe;
    const auto* may = section.get<ConfigTexts>("may");
    if (may == nullptr) return role;
    for (const auto& word : *may) {
      if (word == words[0]) role = std::max(role, Role::operate);
      if (word == words[1]) role = Role::configure;
      if (std::ranges::count(words, word) != 0) continue;
      complain(section.place_of("may"),
               fmt::format("'may' has '{}', but can only have {}.{}", word,
                           fmt::join(words, " and "), tmcl::did_you_mean(word, words)));
    }
    return role;
  }

  using PortPlace = decltype(PortConfig::place);

  /// Nothing, and a complaint, if it is not one of the three, or in use.
  std::optional<PortPlace> place_of_port(const ConfigSection& section) {
    std::optional<PortPlace> place;
    constexpr std::array<std::string_view, 3> keys{"pty", "tcp", "can"};
    const auto given =
        std::ranges::count_if(keys, [&](auto key) { return section.find(key) != nullptr; });
    if (given != 1) {
      complain(section.place,
               "[[port]] needs one of 'pty', 'tcp' and 'can': where its hosts find the bus");
      return place;
    }
    for (const auto key : keys)
      if (const auto* text = section.get<std::string>(key))
        place = parse_place(section, key, *text);
    const auto key =
        *std::ranges::find_if(keys, [&](auto one) { return section.find(one) != nullptr; });
    for (const auto& other : config_.ports) {
      if (!place || text_of(other.place) != text_of(*place)) continue;
      complain(section.place_of(key), "port " + quoted(other.name) + " is there already");
    }
    return place;
  }

  std::optional<PortPlace> parse_place(const ConfigSection& section, std::string_view key,
                                       const std::string& text) {
    if (key == "pty") {
      if (!text.empty()) return PtyName{text};
      complain(section.place_of(key), "'pty' must be a path");
      return std::nullopt;
    }
    auto link = tmcl::parse_link_name(std::string(key) + ":" + text);
    if (!link) {
      const std::string form = key == "tcp" ? "HOST:PORT" : "the name of an interface";
      complain(section.place_of(key), fmt::format("'{}' is '{}', but must be {}", key, text, form));
      return std::nullopt;
    }
    for (const auto& bus : config_.buses) {
      if (to_string(bus.link) != to_string(*link)) continue;
      complain(section.place_of(key), "bus " + quoted(bus.name) + " is there: a port needs " +
                                          (key == "can" ? "an interface" : "a place") +
                                          " of its own");
    }
    if (const auto* tcp = std::get_if<tmcl::TcpName>(&*link)) return *tcp;
    return std::get<tmcl::CanName>(*link);
  }

  const BusConfig* find_bus(const ConfigSection& section, const std::string& name) {
    const auto found = std::ranges::find(config_.buses, name, &BusConfig::name);
    if (found != config_.buses.end()) return &*found;
    // A bus that was refused has been complained about already; its axes are innocent.
    if (has_nameless_bus_ || std::ranges::count(declared_buses_, name) != 0) return nullptr;
    const std::vector<std::string_view> known(declared_buses_.begin(), declared_buses_.end());
    complain(section.place_of("bus"),
             "there is no bus " + quoted(name) + "." + tmcl::did_you_mean(name, known));
    return nullptr;
  }

  void check_whole() {
    if (config_.buses.size() > max_buses) {
      complain({}, "more than " + std::to_string(max_buses) + " buses");
    }
    if (config_.axes.size() > max_axes) {
      complain({}, "more than " + std::to_string(max_axes) + " axes");
    }
    if (config_.ports.size() > max_ports) {
      complain({}, "more than " + std::to_string(max_ports) + " ports");
    }
  }

  std::vector<ConfigProblem>& problems_;
  std::vector<std::string> declared_buses_;
  bool has_nameless_bus_ = false;
  Config config_;
};

}  // namespace

Config build_config(std::span<const ConfigSection> sections, std::vector<ConfigProblem>& problems) {
  return Builder(problems).build(sections);
}

}  // namespace tmcld
