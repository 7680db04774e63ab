/// What tmcld is told to do: plain values, already checked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tmcl/bus_options.hpp"
#include "tmcl/link.hpp"
#include "tmcl/link_name.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl {
struct Settings;
}

namespace tmcld {

/// Bounds of a configuration; more than a gateway has ports for.
constexpr std::size_t max_buses = 32;
constexpr std::size_t max_axes = 256;
constexpr std::size_t max_ports = 32;

enum class LogLevel : std::uint8_t { error, warning, info, debug };

/// What becomes of axes that move when the daemon ends. Those that it leads are stopped always.
enum class OnExit : std::uint8_t { stop, keep };

struct DaemonConfig {
  std::string socket;
  LogLevel log_level = LogLevel::info;
  OnExit on_exit = OnExit::stop;
  /// Directory of the journal; empty: $STATE_DIRECTORY, or else where the socket is.
  std::string state{};
  std::string audit{};  ///< File for what was moved and set, by whom; empty: the log.
  bool moves_need_lease = false;
  std::size_t planning_memory_mb = 64;
  std::string managed{};  ///< File of the configuration that clients may set; empty: none.

  std::size_t planning_bytes() const { return planning_memory_mb << 20U; }
};

/// What a client may do: also what those before it may.
enum class Role : std::uint8_t { stop, observe, operate, configure };
constexpr std::array<std::string_view, 4> role_names{"stop", "observe", "operate", "configure"};
constexpr std::string_view name_of(Role role) { return role_names[static_cast<std::size_t>(role)]; }

/// A user or a group.
struct Account {
  std::string name;
  std::uint32_t id = 0;
};

struct AccessConfig {
  Role role = Role::observe;
  std::vector<Account> users{};
  std::vector<Account> groups{};
  bool relays = false;  ///< They may speak for others, who have no more than this role then.
};

/// What one module was measured to be like.
struct MeasuredModule {
  const tmcl::Model* model = nullptr;  ///< Null: it was not measured.
  tmcl::ModuleTraits traits{};
};

/// By what it is noticed that a module has restarted.
struct SentinelConfig {
  enum class Kind : std::uint8_t { tick, variable, settings, none };
  Kind kind = Kind::tick;
  std::uint8_t variable = 0;
};

/// What a module is to be set to.
struct SettingsConfig {
  enum class Drift : std::uint8_t { report, restore };
  std::shared_ptr<const tmcl::Settings> wanted{};  ///< Null: nothing is said about that.
  std::string file{};
  Drift at_reset = Drift::report;
};

struct ModuleConfig {
  tmcl::ModuleAddress address{};
  SentinelConfig sentinel{};
  /// After so long without a command it stops its motors; 0: never. Nothing: it is left alone.
  std::optional<std::int32_t> deadman_ms{};
  MeasuredModule as{};
  SettingsConfig settings{};
};

struct BusConfig {
  std::string name;
  tmcl::LinkName link;
  tmcl::LinkOptions link_options;
  tmcl::BusOptions bus_options;         ///< `name` is the configured one, so that errors carry it.
  std::vector<ModuleConfig> modules{};  ///< Those that something is said about.
  /// All that is said about it, its modules and its axes: another text, another bus.
  std::string said{};
};

/// What an axis is measured in.
struct ScaleConfig {
  std::string unit;                 ///< Empty: none; positions are told in microsteps only.
  double units_per_revolution = 1;  ///< Behind the gear.
  double gear_ratio = 1;
  bool reverse = false;
  std::int32_t full_steps = 200;
  std::optional<std::int32_t> microstep_resolution;  ///< Exponent of two; absent: the module's.
  std::optional<tmcl::SoftLimits> limits;            ///< In the unit; without one in microsteps.
  /// Only with a unit. Nothing: what the encoder reads is in microsteps, or there is none.
  std::optional<double> encoder_counts_per_unit;
  bool encoder_is_linear = false;  ///< It measures where the axis is, and not how its motor turns.
  std::shared_ptr<const tmcl::Correction> correction;  ///< Only with a unit. Null: none.

  /// With so many microsteps of a full step, as an exponent of two.
  tmcl::UserScale with_resolution(std::int32_t resolution) const {
    return {unit, units_per_revolution, reverse, {full_steps, resolution}, gear_ratio, correction};
  }
};

/// What the settings of an axis must not go beyond, and nothing that it is told. In its unit per
/// second; without one in microsteps.
struct MotionLimits {
  std::optional<double> velocity{};
  std::optional<double> acceleration{};
  std::optional<double> deceleration{};   ///< Without one, it is that of the acceleration.
  std::optional<double> jerk{};           ///< That its S-curves must have; without them it stands.
  std::optional<std::int32_t> current{};  ///< As the module counts it.
  /// By which its speed may change at once in a corner of a path.
  std::optional<double> corner_jump{};

  /// Whether settings and commands have to be looked at.
  bool of_settings() const { return velocity || acceleration || deceleration || jerk || current; }
};

/// When a move is done, by an encoder.
struct InPosition {
  double window = 0;  ///< In the unit of the axis, to either side; without one in microsteps.
  tmcl::Duration settle = std::chrono::milliseconds(100);
};

/// How it comes to the targets of moves.
struct ApproachConfig {
  bool from_below = true;
  double distance = 0;  ///< So far beyond a target it goes first; in the unit or in microsteps.
};

struct AxisConfig {
  std::string name;
  std::string bus;
  tmcl::AxisAddress address;
  ScaleConfig scale{};
  /// It is not sent to a position before it has searched its reference.
  bool needs_reference = false;
  MotionLimits motion_limits{};
  /// The farthest that a reference search may go one way, in the unit, or in microsteps.
  std::optional<double> home_max_travel{};
  std::optional<InPosition> in_position{};
  std::optional<ApproachConfig> approach{};  ///< Nothing: straight.
};

/// An output of a module, and what it is set to.
struct OutputSetting {
  std::string bus;
  tmcl::ModuleAddress module{};
  std::uint8_t port = 0;
  std::int32_t value = 0;
};
/// "bench:1 output 0 1", as a configuration says it.
std::string to_string(const OutputSetting& output);

/// What paths of G-code are read and run with.
struct PathConfig {
  /// What M3, M4, M5, M7, M8 and M9 switch, by their numbers; nothing for others.
  std::map<std::uint8_t, OutputSetting> words{};
  /// Of G54 to G59, for X Y Z A B C: in mm and degrees from the zero of the axes.
  std::array<std::optional<std::array<double, 6>>, 6> origins{};
  std::map<int, double> tools{};  ///< How long they are, in mm, by their numbers.
};

struct PtyName {
  std::string path;  ///< Of a symbolic link to the pseudo terminal.
};

/// Where a host that speaks TMCL finds a bus, as if it were alone there.
struct PortConfig {
  std::string name;
  std::string bus;
  std::variant<PtyName, tmcl::TcpName, tmcl::CanName> place;
  Role role = Role::observe;  ///< operate: it may move; configure: everything.
};

/// Every axis is on one of the buses; names are unique, and so are motors.
struct Config {
  DaemonConfig daemon;
  std::vector<BusConfig> buses;
  std::vector<AxisConfig> axes;
  std::vector<AccessConfig> access{};  ///< Empty: every client may do everything.
  std::vector<PortConfig> ports{};
  PathConfig path{};
  /// All that is said in sections of other kinds than these.
  std::string others{};
};

}  // namespace tmcld
