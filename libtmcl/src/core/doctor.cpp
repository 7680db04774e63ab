#include "tmcl/doctor.hpp"

#include <array>
#include <cstddef>

namespace tmcl {
namespace {

constexpr auto check_table = std::to_array<CheckInfo>({
    {Check::port, "port", "does the port exist?",
     "plug it in; 'tmclctl ports' lists what is there, with names that stay"},
    {Check::access, "access", "may this user open the port?",
     "join its group ('sudo adduser $USER dialout'), then log in again"},
    {Check::holder, "holder", "is the port free of other programs?",
     "end that program, or let tmcld own the port and ask tmcld"},
    {Check::modem_manager, "modem_manager", "does ModemManager leave the port alone?",
     "a udev rule with ENV{ID_MM_PORT_IGNORE}=\"1\" keeps it away; or "
     "'sudo systemctl stop ModemManager'"},
    {Check::latency, "latency", "does the adapter pass on each byte at once?",
     "write 1 to /sys/class/tty/PORT/device/latency_timer, as root, or by a udev rule"},
    {Check::gateway, "gateway", "does tmcld answer?",
     "'systemctl status tmcld' says why not; '--direct LINK' works without it"},
    {Check::clock, "clock", "is the clock of this computer right?",
     "'timedatectl' shows it; certificates, tokens and logs go by it"},
    {Check::stalls, "stalls", "does tmcld run without pauses?",
     "give it real-time priority, as its service has, or this computer less to do"},
    {Check::journal, "journal", "can tmcld write its journal?",
     "look at the disk and at 'state' in the configuration: without a journal, the next tmcld "
     "cannot stop what a killed one has left moving"},
    {Check::bus, "bus", "is the bus open?",
     "see what is said about its port; tmcld opens it again by itself"},
    {Check::replies, "replies", "are requests answered?",
     "look at ground, shield, termination and baud rate; 'tmclctl trace {}' shows every datagram"},
    {Check::noise, "noise", "is the line free of stray bytes?",
     "look at shield and termination, and whether the baud rate is a little off"},
    {Check::module, "module", "does the module answer?",
     "look at its supply and its cable; 'tmclctl scan' tells who answers, and at which address"},
    {Check::address, "address", "does one module alone have the address?",
     "take all but one off the line, and give that one another address (global parameter 66)"},
    {Check::model, "model", "is its model known?",
     "it works by numbers of parameters; 'tmclctl models' lists what is known by name"},
    {Check::program, "program", "is the module free of running programs?",
     "'tmclctl program stop {}' ends it; global parameter 77 starts it with the supply"},
    {Check::restart, "restart", "is it noticed when the module starts again?",
     "'sentinel' in its [[module]] names a user variable that tmcld may use"},
    {Check::settings, "settings", "are its settings those of its file?",
     "'tmclctl settings load FILE {}' sets them; settings_at_reset = \"restore\" does by itself"},
    {Check::deadman, "deadman", "is its deadman as configured?",
     "'tmclctl deadman set AXIS MS', then 'tmclctl deadman test AXIS'"},
    {Check::motor, "motor", "does its module have such a motor?",
     "'motor' in its [[axis]] counts from 0"},
    {Check::supply, "supply", "does the motor have its supply?",
     "look at the pins of the motor's supply: many modules take logic and motors on two"},
    {Check::temperature, "temperature", "is the driver cool enough?",
     "let it cool, and give it less current ('max_current', 'standby_current') or more air"},
    {Check::driver, "driver", "does the driver drive both coils?",
     "switch the supply off, and look at the plug and the wires of the motor"},
    {Check::current, "current", "does the motor get a current?",
     "'tmclctl set {} max_current 128' is half of what the module can; what the motor may have is "
     "on "
     "its plate"},
    {Check::velocity, "velocity", "is its greatest speed above 0?",
     "'tmclctl ramp {} --velocity ... --acceleration ...' sets what moves need"},
    {Check::acceleration, "acceleration", "is its acceleration above 0?",
     "'tmclctl ramp {} --velocity ... --acceleration ...' sets what moves need"},
    {Check::resolution, "resolution", "does it count the microsteps of the configuration?",
     "'tmclctl set {} microstep_resolution N', then 'tmclctl store {} microstep_resolution'"},
    {Check::latch, "latch", "is it free to move, not latched?",
     "'tmclctl home {}', or, after a look at the machine, 'tmclctl recover {}'"},
    {Check::reference, "reference", "has it found its reference?", "'tmclctl home {}' searches it"},
    {Check::limits, "limits", "is it within its soft limits?",
     "move it back to within them: 'tmclctl move {} POSITION'"},
    {Check::switches, "switches", "is at least one limit switch open?",
     "an open input reads as a closed switch: 'tmclctl set {} right_limit_switch_disable 1' where "
     "there is none, and the same with left"},
    {Check::restored, "restored", "are the settings that a path changed set back?",
     "they are set back as soon as its module answers"},
    {Check::stop, "stop", "is it where it was sent to?",
     "'tmclctl errors {}' says what its module knows of it; then send it again"},
});

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < check_table.size(); ++i)
    if (static_cast<std::size_t>(check_table.at(i).check) != i) return false;
  return true;
}
static_assert(is_in_order());

}  // namespace

std::span<const CheckInfo> checks() { return check_table; }

const CheckInfo& info_of(Check check) { return check_table.at(static_cast<std::size_t>(check)); }

std::string cure_of(const Finding& finding) {
  if (!finding.cure.empty()) return finding.cure;
  std::string text(info_of(finding.check).cure);
  for (auto at = text.find("{}"); at != std::string::npos; at = text.find("{}", at))
    text.replace(at, 2, finding.subject);
  return text;
}

}  // namespace tmcl
