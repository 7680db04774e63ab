#include "config/keys.hpp"

#include <algorithm>
#include <array>

#include "config/feeding.hpp"
#include "tmcl/mechanics.hpp"

namespace tmcld {
namespace {

using enum SectionKind;
using enum KeyType;
constexpr bool required = true;
constexpr bool optional = false;
constexpr auto any = LinkScope::any;
constexpr auto can = LinkScope::can;
constexpr auto tcp = LinkScope::tcp;
constexpr auto framed = LinkScope::serial_framing;

constexpr auto keys = std::to_array<KeyInfo>({
    {daemon, "socket", string, required, 0, 0, any, "path of the unix socket that clients use"},
    {daemon, "log_level", string, optional, 0, 0, any, "error, warning, info or debug"},
    {daemon, "state", string, optional, 0, 0, any,
     "directory of what tmcld has to know when it was killed; $STATE_DIRECTORY, or where the "
     "socket is"},
    {daemon, "on_exit", string, optional, 0, 0, any,
     "stop: axes that move are stopped when tmcld ends; keep: only those that it leads"},
    {daemon, "audit", string, optional, 0, 0, any,
     "file for a line about every movement and every setting, and who asked for it"},
    {daemon, "moves_need_lease", boolean, optional, 0, 0, any,
     "who moves an axis needs a lease of it, but for lines and paths"},
    {daemon, "planning_memory_mb", integer, optional, 8, 4096, any,
     "memory for paths and programs that wait to be planned or are run; half of it for one client"},

    {http, "listen", strings, required, 0, 0, any,
     "addresses that are served, such as 127.0.0.1:4143"},
    {http, "certificate", string, optional, 0, 0, any,
     "file of the certificate and those that vouch for it, in PEM"},
    {http, "key", string, optional, 0, 0, any, "file of the key of the certificate, in PEM"},
    {http, "client_ca", string, optional, 0, 0, any,
     "file of the certificates that vouch for those of clients, which must have one then"},
    {http, "origins", strings, optional, 0, 0, any,
     "origins of pages that may call tmcld, besides one that comes from its own address"},
    {http, "loopback_without_token", boolean, optional, 0, 0, any,
     "programs of this computer need no token on loopback addresses"},

    {access, "role", string, required, 0, 0, any,
     "what they may do: observe, operate or configure"},
    {access, "users", strings, optional, 0, 0, any, "names of users"},
    {access, "groups", strings, optional, 0, 0, any, "names of groups"},

    {bus, "name", string, required, 0, 0, any, "how axes and clients call this bus"},
    {bus, "link", string, required, 0, 0, any,
     "serial:DEVICE@BAUD, usb:PORT, can:INTERFACE or tcp:HOST:PORT"},
    {bus, "reply_timeout_ms", integer, optional, 1, 60000, any,
     "how long a module may take to answer, besides the time on the wire"},
    {bus, "attempts", integer, optional, 1, 10, any,
     "how often a command that may be repeated is sent before it counts as failed"},
    {bus, "quiet_time_ms", integer, optional, 0, 10000, any, "silence after an unanswered request"},
    {bus, "silence_time_ms", integer, optional, 0, 60000, any,
     "how long a module that did not answer is not asked again"},
    {bus, "telegram_pause_ms", integer, optional, 0, 255, framed,
     "the modules' telegram pause time (global parameter 75)"},
    {bus, "host_address", integer, optional, 0, 255, framed,
     "the modules' serial host address (global parameter 76)"},
    {bus, "can_reply_id", integer, optional, 0, 0x7FF, can,
     "identifier of the modules' replies (global parameter 70)"},
    {bus, "can_extended", boolean, optional, 0, 0, can, "29-bit identifiers"},
    {bus, "connect_timeout_ms", integer, optional, 1, 60000, tcp, "how long connecting may take"},

    {module, "bus", string, required, 0, 0, any, "name of the bus the module is on"},
    {module, "address", integer, required, 0, 0x7FF, any, "address of the module"},
    {module, "sentinel", string, optional, 0, 0, any,
     "by what a restart of it is noticed: auto, tick, variable:N, settings or none"},
    {module, "deadman_ms", integer, optional, 0, longest_deadman_ms, any,
     "it stops its motors when no host has sent it anything for so long; 0: never"},
    {module, "as", string, optional, 0, 0, any, "file about what was measured of it"},

    {axis, "name", string, required, 0, 0, any, "how clients call this axis"},
    {axis, "bus", string, required, 0, 0, any, "name of the bus the module is on"},
    {axis, "address", integer, required, 0, 0x7FF, any, "address of the module"},
    {axis, "motor", integer, required, 0, 255, any, "number of the motor on its module, from 0"},
    {axis, "unit", string, optional, 0, 0, any, "what its positions are measured in, such as mm"},
    {axis, "units_per_revolution", number, optional, 0, 0, any,
     "how many of these units a turn is: of the motor, or of what its gear drives"},
    {axis, "screw_pitch", number, optional, 0, 0, any,
     "how many of these units a turn of the screw is; instead of units_per_revolution"},
    {axis, "gear_ratio", number, optional, 0, 0, any,
     "turns of the motor for one turn of what it drives"},
    {axis, "reverse", boolean, optional, 0, 0, any,
     "positions in the unit grow in the motor's negative direction"},
    {axis, "full_steps", integer, optional, 1, tmcl::max_full_steps, any,
     "full steps of a turn of the motor"},
    {axis, "microsteps", integer, optional, 1, 1 << tmcl::max_microstep_resolution, any,
     "microsteps of a full step: a power of two"},
    {axis, "soft_limits", range, optional, 0, 0, any,
     "least and greatest position in the unit, or in microsteps without one: moves to beyond are "
     "refused"},
    {axis, "encoder_lines", integer, optional, 1, tmcl::max_encoder_lines, any,
     "lines of an encoder on the motor's shaft, if its position is read in counts"},
    {axis, "encoder_quadrature", boolean, optional, 0, 0, any, "four counts to each of its lines"},
    {axis, "encoder_counts_per_unit", number, optional, 0, 0, any,
     "counts of a linear encoder in one unit; instead of encoder_lines"},
    {axis, "reference", string, optional, 0, 0, any,
     "required: it is sent to no position before it has searched its reference; or optional"},
    {axis, "home_max_travel", number, optional, 0, 0, any,
     "how far a reference search may go one way, in the unit or in microsteps; the length of "
     "soft_limits and a tenth if absent"},
    {axis, "max_velocity", number, optional, 0, 0, any,
     "greatest speed in the unit per second, or in microsteps: no client sets or asks for a higher "
     "one"},
    {axis, "max_acceleration", number, optional, 0, 0, any,
     "greatest acceleration, per second squared, held as max_velocity is"},
    {axis, "max_deceleration", number, optional, 0, 0, any,
     "greatest deceleration, held as max_velocity is; max_acceleration if absent"},
    {axis, "max_jerk", number, optional, 0, 0, any,
     "greatest jerk, per second cubed, held as max_velocity is: for modules that make S-curves "
     "(TMC457); the axis "
     "takes part in no line and no path then"},
    {axis, "max_corner_jump", number, optional, 0, 0, any,
     "by which its speed may change at once in a corner of a path, in the unit per second, or in "
     "microsteps"},
    {axis, "max_current", integer, optional, 0, 255, any,
     "greatest current, as the module counts it, held as max_velocity is"},

    {port, "name", string, required, 0, 0, any, "how the log and holders of leases call this port"},
    {port, "bus", string, required, 0, 0, any, "name of the bus that its host speaks to"},
    {port, "pty", string, optional, 0, 0, any,
     "path of a link to a pseudo terminal, on which the host finds the bus"},
    {port, "tcp", string, optional, 0, 0, any,
     "HOST:PORT where hosts find the bus; instead of pty"},
    {port, "can", string, optional, 0, 0, any,
     "CAN interface, such as a virtual one, where the host finds the bus; instead of pty"},
    {port, "may", strings, optional, 0, 0, any,
     "what hosts may do besides reading and stopping: move, configure"},
});

}  // namespace

std::string_view title_of(SectionKind section) {
  switch (section) {
    case daemon: return "[daemon]";
    case http: return "[http]";
    case access: return "[[access]]";
    case bus: return "[[bus]]";
    case module: return "[[module]]";
    case axis: return "[[axis]]";
    case port: return "[[port]]";
  }
  return {};
}

std::string_view name_of(KeyType type) {
  switch (type) {
    case string: return "a text in quotes";
    case strings: return "a list of texts, [\"one\", \"another\"]";
    case integer: return "a whole number";
    case number: return "a number";
    case boolean: return "true or false";
    case range: return "two numbers in brackets, [least, greatest]";
  }
  return {};
}

std::string_view name_of(LinkScope scope) {
  switch (scope) {
    case LinkScope::any: return "any";
    case LinkScope::can: return "can:";
    case LinkScope::tcp: return "tcp:";
    case LinkScope::serial_framing: return "serial: and tcp:";
  }
  return {};
}

std::span<const KeyInfo> config_keys() { return keys; }

const KeyInfo* find_key(SectionKind section, std::string_view name) {
  const auto* row = std::ranges::find_if(
      keys, [&](const KeyInfo& key) { return key.section == section && key.name == name; });
  return row == keys.end() ? nullptr : row;
}

}  // namespace tmcld
