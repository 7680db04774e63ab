/// The sections of a configuration file and their keys, free of the TOML library.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/key.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcld {

using Milliseconds = std::chrono::milliseconds;
constexpr std::int64_t max_can_address = 0x7FF;

struct DaemonSection : Section {
  TMCL_SECTION(DaemonSection, "[daemon]");
  TMCL_KEY(Needed<std::string>, socket, "path of the unix socket that clients use");
  TMCL_KEY(Said<std::string>, log_level, "error, warning, info or debug");
  TMCL_KEY(Said<std::string>, state,
           "directory of what tmcld has to know when it was killed; $STATE_DIRECTORY, or where "
           "the socket is");
  TMCL_KEY(Said<std::string>, on_exit,
           "stop: axes that move are stopped when tmcld ends; keep: only those that it leads");
  TMCL_KEY(Said<std::string>, audit,
           "file for a line about every movement and every setting, and who asked for it");
  TMCL_KEY(Said<bool>, moves_need_lease,
           "who moves an axis needs a lease of it, but for lines and paths");
  TMCL_KEY(Said<std::size_t>, planning_memory_mb,
           "memory for paths and programs that wait to be planned or are run; half of it for one "
           "client",
           {8, 4096});
  TMCL_KEY(Said<std::string>, managed,
           "file of buses, modules, axes and [path] that clients with the role configure may set");
};

struct HttpSection : Section {
  TMCL_SECTION(HttpSection, "[http]");
  TMCL_KEY(Needed<ConfigTexts>, listen, "addresses that are served, such as 127.0.0.1:4143");
  TMCL_KEY(Said<std::string>, certificate,
           "file of the certificate and those that vouch for it, in PEM");
  TMCL_KEY(Said<std::string>, key, "file of the key of the certificate, in PEM");
  TMCL_KEY(Said<std::string>, client_ca,
           "file of the certificates that vouch for those of clients, which must have one then");
  TMCL_KEY(Said<ConfigTexts>, origins,
           "origins of pages that may call tmcld, besides one that comes from its own address");
  TMCL_KEY(Said<bool>, loopback_without_token,
           "programs of this computer need no token on loopback addresses");
  TMCL_KEY(Said<std::string>, page, "folder of the page for browsers");
};

struct AccessSection : Section {
  TMCL_SECTION(AccessSection, "[[access]]");
  TMCL_KEY(Needed<std::string>, role, "what they may do: observe, operate or configure");
  TMCL_KEY(Said<ConfigTexts>, users, "names of users");
  TMCL_KEY(Said<ConfigTexts>, groups, "names of groups");
  TMCL_KEY(Said<bool>, relay,
           "they are programs that bring calls of others, such as tmcld-mqtt, and may name these "
           "and the role of each, up to this one");
};

struct BusSection : Section {
  TMCL_SECTION(BusSection, "[[bus]]");
  TMCL_KEY(Needed<std::string>, name, "how axes and clients call this bus");
  TMCL_KEY(Needed<std::string>, link,
           "serial:DEVICE@BAUD, usb:PORT, can:INTERFACE or tcp:HOST:PORT");
  TMCL_KEY(Said<Milliseconds>, reply_timeout_ms,
           "how long a module may take to answer, besides the time on the wire", {1, 60000});
  TMCL_KEY(Said<unsigned>, attempts,
           "how often a command that may be repeated is sent before it counts as failed", {1, 10});
  TMCL_KEY(Said<Milliseconds>, quiet_time_ms, "silence after an unanswered request", {0, 10000});
  TMCL_KEY(Said<Milliseconds>, silence_time_ms,
           "how long a module that did not answer is not asked again", {0, 60000});
  TMCL_KEY(Said<Milliseconds>, telegram_pause_ms,
           "the modules' telegram pause time (global parameter 75)", {0, 255});
  TMCL_KEY(Said<std::uint8_t>, host_address,
           "the modules' serial host address (global parameter 76)");
  TMCL_KEY(Said<std::uint32_t>, can_reply_id,
           "identifier of the modules' replies (global parameter 70)", {0, max_can_address});
  TMCL_KEY(Said<bool>, can_extended, "29-bit identifiers");
  TMCL_KEY(Said<Milliseconds>, connect_timeout_ms, "how long connecting may take", {1, 60000});
};

struct ModuleSection : Section {
  TMCL_SECTION(ModuleSection, "[[module]]");
  TMCL_KEY(Needed<std::string>, bus, "name of the bus the module is on");
  TMCL_KEY(Needed<std::uint16_t>, address, "address of the module", {0, max_can_address});
  TMCL_KEY(Said<std::string>, sentinel,
           "by what a restart of it is noticed: auto, tick, variable:N, settings or none");
  TMCL_KEY(Said<std::uint16_t>, deadman_ms,
           "it stops its motors when no host has sent it anything for so long; 0: never");
  TMCL_KEY(Said<std::string>, as, "file about what was measured of it");
  TMCL_KEY(Said<std::string>, settings,
           "file of settings; the module is compared with it at start and after a reset");
  TMCL_KEY(Said<std::string>, settings_at_reset,
           "what to do about a difference: report (an event), or restore (set it again, too)");
};

struct AxisSection : Section {
  TMCL_SECTION(AxisSection, "[[axis]]");
  TMCL_KEY(Needed<std::string>, name, "how clients call this axis");
  TMCL_KEY(Needed<std::string>, bus, "name of the bus the module is on");
  TMCL_KEY(Needed<std::uint16_t>, address, "address of the module", {0, max_can_address});
  TMCL_KEY(Needed<std::uint8_t>, motor, "number of the motor on its module, from 0");
  TMCL_KEY(Said<std::string>, unit, "what its positions are measured in, such as mm");
  TMCL_KEY(Said<double>, units_per_revolution,
           "how many of these units a turn is: of the motor, or of what its gear drives");
  TMCL_KEY(Said<double>, screw_pitch,
           "how many of these units a turn of the screw is; instead of units_per_revolution");
  TMCL_KEY(Said<double>, gear_ratio, "turns of the motor for one turn of what it drives");
  TMCL_KEY(Said<bool>, reverse, "positions in the unit grow in the motor's negative direction");
  TMCL_KEY(Said<std::int32_t>, full_steps, "full steps of a turn of the motor",
           {1, tmcl::max_full_steps});
  TMCL_KEY(Said<std::uint32_t>, microsteps, "microsteps of a full step: a power of two",
           {1, 1 << tmcl::max_microstep_resolution});
  TMCL_KEY(Said<std::string>, correction,
           "file of where it really is, by where its steps say: two numbers a line, in the unit");
  TMCL_KEY(Said<ConfigRange>, soft_limits,
           "least and greatest position in the unit, or in microsteps without one: moves to "
           "beyond are refused");
  TMCL_KEY(Said<std::int32_t>, encoder_lines,
           "lines of an encoder on the motor's shaft, if its position is read in counts",
           {1, tmcl::max_encoder_lines});
  TMCL_KEY(Said<bool>, encoder_quadrature, "four counts to each of its lines");
  TMCL_KEY(Said<double>, encoder_counts_per_unit,
           "counts of a linear encoder in one unit; instead of encoder_lines");
  TMCL_KEY(Said<std::string>, approach,
           "from-below or from-above: it comes to the targets of moves from that side only");
  TMCL_KEY(
      Said<double>, approach_distance,
      "so far beyond a target it goes first then, in the unit, or in microsteps: more than its "
      "play");
  TMCL_KEY(
      Said<double>, in_position,
      "how near its target its encoder must be for a move to count as done, in the unit, or in "
      "microsteps");
  TMCL_KEY(Said<std::uint16_t>, settle_ms, "for how long it must be so near; 100 if absent",
           {1, 60'000});
  TMCL_KEY(Said<std::string>, reference,
           "required: it is sent to no position before it has searched its reference; or optional");
  TMCL_KEY(Said<double>, home_max_travel,
           "how far a reference search may go one way, in the unit or in microsteps; the length "
           "of soft_limits and a tenth if absent");
  TMCL_KEY(Said<double>, max_velocity,
           "greatest speed in the unit per second, or in microsteps: no client sets or asks for a "
           "higher one");
  TMCL_KEY(Said<double>, max_acceleration,
           "greatest acceleration, per second squared, held as max_velocity is");
  TMCL_KEY(Said<double>, max_deceleration,
           "greatest deceleration, held as max_velocity is; max_acceleration if absent");
  TMCL_KEY(Said<double>, max_jerk,
           "greatest jerk, per second cubed, held as max_velocity is: for modules that make "
           "S-curves (TMC457); the axis takes part in no line and no path then");
  TMCL_KEY(Said<double>, max_corner_jump,
           "by which its speed may change at once in a corner of a path, in the unit per second, "
           "or in microsteps");
  TMCL_KEY(Said<std::int32_t>, max_current,
           "greatest current, as the module counts it, held as max_velocity is", {0, 255});
};

struct PortSection : Section {
  TMCL_SECTION(PortSection, "[[port]]");
  TMCL_KEY(Needed<std::string>, name, "how the log and holders of leases call this port");
  TMCL_KEY(Needed<std::string>, bus, "name of the bus that its host speaks to");
  TMCL_KEY(Said<std::string>, pty,
           "path of a link to a pseudo terminal, on which the host finds the bus");
  TMCL_KEY(Said<std::string>, tcp, "HOST:PORT where hosts find the bus; instead of pty");
  TMCL_KEY(Said<std::string>, can,
           "CAN interface, such as a virtual one, where the host finds the bus; instead of pty");
  TMCL_KEY(Said<ConfigTexts>, may,
           "what hosts may do besides reading and stopping: move, configure");
};

struct PathSection : Section {
  TMCL_SECTION(PathSection, "[path]");
  TMCL_KEY(Said<std::string>, m3, "what M3 of G-code switches: BUS:ADDRESS output PORT VALUE");
  TMCL_KEY(Said<std::string>, m4, "what M4 switches");
  TMCL_KEY(Said<std::string>, m5,
           "what M5 switches; also when a path ends after M3 or M4, and without M5");
  TMCL_KEY(Said<std::string>, m7, "what M7 switches");
  TMCL_KEY(Said<std::string>, m8, "what M8 switches");
  TMCL_KEY(Said<std::string>, m9,
           "what M9 switches; also when a path ends after M7 or M8, and without M9");
  TMCL_KEY(Said<ConfigNumbers>, g54,
           "where positions of G54 count from, in mm and degrees from the zero of the axes: "
           "{x = 10, y = 5}");
  TMCL_KEY(Said<ConfigNumbers>, g55, "the same of G55");
  TMCL_KEY(Said<ConfigNumbers>, g56, "the same of G56");
  TMCL_KEY(Said<ConfigNumbers>, g57, "the same of G57");
  TMCL_KEY(Said<ConfigNumbers>, g58, "the same of G58");
  TMCL_KEY(Said<ConfigNumbers>, g59, "the same of G59");
  TMCL_KEY(Said<ConfigNumbers>, tools,
           "how long tools are along Z, in mm, by their numbers: {1 = 12.5, 2 = 30}");
};
/// Its keys of M words, by their numbers.
struct PathWordKey {
  std::uint8_t word;
  Said<std::string> PathSection::*key;
};
inline constexpr std::array path_word_keys{
    PathWordKey{3, &PathSection::m3}, PathWordKey{4, &PathSection::m4},
    PathWordKey{5, &PathSection::m5}, PathWordKey{7, &PathSection::m7},
    PathWordKey{8, &PathSection::m8}, PathWordKey{9, &PathSection::m9}};
inline constexpr std::array path_origin_keys{&PathSection::g54, &PathSection::g55,
                                             &PathSection::g56, &PathSection::g57,
                                             &PathSection::g58, &PathSection::g59};

/// What one file says, or several, one after the other.
struct ConfigText {
  std::vector<std::string> files{};     ///< Their paths; empty ones of texts that are in none.
  bool is_toml = true;                  ///< If not, there are no sections of it, and one problem.
  bool names_daemon = false;            ///< Its section, right or wrong.
  std::vector<DaemonSection> daemon{};  ///< More than one only of several files; `http` and
                                        ///< `path`, too.
  std::vector<HttpSection> http{};
  std::vector<PathSection> path{};
  std::vector<AccessSection> access{};
  std::vector<BusSection> buses{};
  std::vector<ModuleSection> modules{};
  std::vector<AxisSection> axes{};
  std::vector<PortSection> ports{};
  tmcl::TextProblems problems{};
};

/// What is for a daemon alone: [daemon] and [http]. Refused with it is what else clients may not
/// set: [[access]] and [[port]].
enum class OfDaemon : std::uint8_t { read, ignored, refused };

/// Reads TOML, checks its sections and keys, and appends them to `text`. Never throws.
void read_sections(std::string_view toml, const std::string& file, OfDaemon daemon,
                   ConfigText& text);

/// Those of all sections.
std::vector<Key> config_keys();

}  // namespace tmcld
