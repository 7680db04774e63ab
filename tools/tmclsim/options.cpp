#include "options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "bench_file.hpp"
#include "module_file.hpp"
#include "number_text.hpp"
#include "settings_words.hpp"
#include "tmcl/spelling.hpp"

namespace tmclsim {
namespace {

constexpr auto known_options = std::to_array<std::string_view>(
    {"--module",  "--firmware", "--as",    "--bench",   "--pty",   "--usb-pty", "--usb",
     "--can",     "--tcp",      "--pace",  "--echo",    "--noise", "--eeprom",  "--seed",
     "--gateway", "--replay",   "--debug", "--console", "--help",  "--version"});

constexpr auto description =
    "Simulates TMCL modules: what talks to a module on a wire can talk to this instead.\n"
    "The motors ramp as the real chip's do, in real time. Ends with Ctrl-C.";

constexpr auto explanation = R"(
MODEL is one of those that 'tmclctl models' lists, such as TMCM-3110 (three motors with the ramps of
a TMC429), TMCM-142 (one motor, TMC457) or TMCM-6212 (six motors, sixPoint ramps). ADDRESS is 1 to
255, on serial lines and on CAN alike; without it a module gets the next free one from 1 on. Every
port reaches every module, and a module answers by the port that asked. Ports can be repeated as
well. On CAN modules hear each other, as real ones do: one with address 2 takes the replies of the
others, whose identifier that is, for commands. A module says that it has the firmware of its
model's manual, where that is known; with --firmware behind it, it says VERSION instead.

Examples
  One motor on a serial port that programs open as /tmp/tmcm:
      tmclsim --module TMCM-1110 --pty /tmp/tmcm
  Two modules on one line, at addresses 1 and 7, reached over TCP as well:
      tmclsim --module TMCM-1110@1 --module TMCM-6110@7 --pty /tmp/tmcm --tcp 127.0.0.1:4001
  One whose firmware is an old one, for a host that looks at that:
      tmclsim --module TMCM-3110 --firmware 1.09 --pty /tmp/tmcm
  Commands typed by hand, such as AMVP ABS, 0, 50000, until ABIN goes back to datagrams:
      printf '\1\213\0\0\0\0\0\0\214' > /tmp/tmcm
      picocom --imap crcrlf /tmp/tmcm
  A module as its USB port shows it: it ignores addresses and takes 0.25 to 2 ms to answer:
      tmclsim --module TMCM-3110 --usb-pty /tmp/ttyACM0
  The same as a USB device of this computer, which gets a /dev/ttyACM0 of the kernel's:
      sudo modprobe vhci-hcd && sudo tmclsim --module TMCM-3110 --usb
  A module on a virtual CAN bus:
      sudo ip link add dev vcan0 type vcan && sudo ip link set up vcan0
      tmclsim --module TMCM-3110 --can vcan0

By --usb-pty a host has one module alone on a cable, as by the module's own USB port. The address of
a command is ignored, and answers have the module's own. What the host writes at once is a packet: its
first nine bytes are a command, the rest is lost, and a shorter one is lost whole. With several
modules, ADDRESS= says which one.

With --usb a module is a USB device of this computer: the kernel's cdc_acm makes a terminal of it, and
libusb finds it. gd32 has the descriptors of newer modules, mk20 those of older ones, with packets of
16 bytes, of which a short one waits for the next. When tmclsim ends, the cable is pulled. Needs
root, and the kernel's driver vhci-hcd.

With --pace, requests and answers take as long as on a line of that many baud, or of the rate that each
module has in global parameter 65, and a module takes 0.2 ms; CAN has the rate of global parameter 69.
At the modules' own rates, a host that opens a pseudo terminal at another one hears garbage, and so
does the module. Modules that answer at the same time, as two of one address do, make garbage.

With --bench, motors have something to drive. FILE is TOML; all its keys but model are optional:
    [[module]]
    model = "TMCM-1110"
    address = 1
    firmware_version = "1.09"        # what it says to have, as with --firmware
    behaviour = "lite"               # wrong codes for commands 242 and 255 do nothing and are
                                     # answered ok, as by the vendor's example firmware TMCL-LITE;
                                     # "manual": they are refused
    range_check = "wrap"             # values out of range are cut to the width of what they are
                                     # written to, with a TMC429; "manual": they are refused
    as = "module.toml"               # like the one of that file, as with --as; any key of it can
                                     # stand here, too, and overrules the file
    supply = 23.5                    # of its motors, in volts, or "usb"; below 7 they have no torque
    temperature = 40                 # that it answers, in degrees centigrade
    data_logger = true               # it has command 142, RAMDebug; without the key modules with a
                                     # TMC4361 or a sixPoint ramp have it, and others have not
      [[module.axis]]
      motor = 0
      left_switch = -51200           # closed here and to the left; right_switch to the right
      home = [-100, 100]             # closed from here to there
      switch_tolerance = 20          # a closed switch opens so much later
      normally_closed = false        # limit switches; home_normally_closed of the home switch
      left_stop = -60000             # a mechanical end; right_stop the other one
      position = 1000                # where it stands at first
      encoder_counts_per_turn = 1024
      encoder_sign = -1              # counts down where the motor turns up
      resonance = 12.5               # in Hz: the load, with the encoder, swings behind the motor
      damping = 0.05                 # of its swings, 0 to less than 1
      full_steps_per_turn = 200
      load = 100                     # in 1/1000 of what the motor can drive
      load_per_velocity = 5          # more of it for each full step per second, in 1/1000
      pull = 150                     # of a weight that hangs, down; up if it is below 0
      inertia = 400                  # more for each full step per second squared, in 1/1000000
      corner_speed = 600             # full steps per second at 24 V, above which its torque falls
      pull_in_speed = 200            # below it a motor that has lost steps catches on
      torque_follows_current = true  # otherwise it has all its torque at any current
      load_value_slope = 1000        # so far the load value falls when it is asked for all it has
      load_value_noise = 20          # it is read so much too high or too low at most
      backlash = 40                  # so far it turns before the load, with the encoder, turns round
      driver_faults = ["short_a"]    # as for the console
Places are microsteps of 1/256 of a full step, counted from where the motor stands at first unless
position says otherwise. The modules of the file come before those of --module.

With --as, a module is like one that was measured. FILE is TOML; all its keys but model are optional:
    [module]
    model = "TMCM-1110"              # the same as that of --module
    firmware_version = "1.09"
    answer_us = 1840                 # how long it takes to answer, on serial lines and by USB
    last_step = "r3"                 # of a TMC429, also r1, r2; and factor_rule, order, accumulator
    relative_from = "actual"         # what MVP REL counts from; or target
    relative_answer = "distance"     # what that is answered with; or target
    velocity_target = "turns_on"     # when it turns and its target is set; or goes_there
    limit_stop = "as_set"            # how it stops at a switch, whatever is set: hard, soft
    program_state = "high_byte"      # where command 135 has it; or low_byte
    heartbeat = "stops"              # when no host sends anything; or ignored
    range_check = "manual"           # values out of range are refused; or wrap, with a TMC429
    addressing = "own"               # which commands it takes; or any

With --console, each line on standard input is answered with "ok" or "error: ...":
    load 1/0 500         put so much load on motor 0 of module 1
    slip 1/0 200         shift its encoder by so many counts
    press 1/0 right      hold a switch with a finger: left, right or home
    release 1/0 right
    input 1 0 1          digital input 0 of module 1 is high
    analog 1 0 512       its analogue input 0 reads so much
    driver 1/0 short_a on    something is wrong with the driver of motor 0, or off: it is not.
                         overtemperature, overtemperature_warning, short_a, short_b,
                         open_load_a or open_load_b
    supply 1 23.5        its motors have so many volts, or usb; it goes on
    brown_out 1 200      its motors have too few volts, for so many milliseconds
    temperature 1 40     it has so many degrees centigrade
    power 1 off          its supply fails; on, or cycle for both: it starts again
    shutdown 1 1         its shutdown input is high, for global parameter 80
    run 2.5              with --gateway: let so many seconds of virtual time pass; answered then
    now                  the same: answered with "ok", and the seconds that have passed

With --gateway there is no port: a tmcld with the configuration FILE runs in this process, its buses
lead to these modules whatever their links are, and its clients come by its socket. Time is virtual. It
stands still while no client waits for an answer; while one does, it goes from event to event as fast
as that can be computed, at the pace that a wire has at the baud rate of its link. So a wait for a move
of a minute is over in milliseconds, and ends the same every time. FILE has no [http] and no [[port]].
    tmclsim --module TMCM-3110 --gateway tmcld.toml --console

With --replay, there is no port: the modules are asked what FILE has recorded (tmclctl trace -w), as
far apart as then but in virtual time, and each reply that is not the recorded one is printed. The
record should begin where the module had just been switched on, or been set up. What is read of a
motor that moves may differ by what it goes in some microseconds, and so does the tick timer.
    tmclsim --module TMCM-1110 --as measured.toml --replay bench.pcapng

With --debug, there is no port: a program's text is executed on the one module command by command, in
virtual time, as lines on standard input say: step, continue, break LABEL, back, registers, variables,
watch 3, watch 0 actual_position ...; help shows all. Time stands still between two commands. 'tmclctl
program debug' does the same on a module, but for back and registers, which no module tells.
    tmclsim --module TMCM-1110 --debug loop.tmc

With --eeprom, what modules store (STAP, SGP, programs, coordinates) is in a file for each, such as
DIR/TMCM-1110@1.eeprom, and is there again next time. The name is that of the command line; a module
whose address was changed has the new one.

When all is set up it prints a line for each module and each port, and then "ready".
Exit status: 0 ended as asked, 1 a port or file could not be opened or a reply is not the recorded
one, 2 the command line is wrong.)";

std::string unexpected_word(const std::string& word) {
  if (!word.starts_with("-")) return "'" + word + "' belongs to no option.";
  const auto name = word.substr(0, word.find('='));
  if (name == "--baud")
    return "there is no option '--baud'. --pace gives ports the pace of a baud rate.";
  return "there is no option '" + name + "'." + tmcl::did_you_mean(name, known_options);
}

struct OptionWords {
  std::vector<std::string> modules;
  std::vector<std::string> firmware;
  std::vector<std::string> as;
  std::vector<std::optional<std::string>> firmware_of_module;  // as many as modules
  std::vector<std::optional<std::string>> as_of_module;        // the same
  std::string bench;
  std::vector<std::string> tcp;
  std::vector<std::string> usb_ptys;
  std::vector<std::string> usb_devices;
  std::string pace;
  Options options;
};

void describe(CLI::App& app, OptionWords& words) {
  app.allow_extras();  // so that we can say what was meant instead
  app.set_version_flag("--version", "tmclsim " TMCL_VERSION, "Print the version and exit");
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.footer(explanation);
  const auto repeatable = [&](const char* name, auto& target, const char* type, const char* help) {
    return app.add_option(name, target, help)
        ->type_name(type)
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  repeatable("--module", words.modules, "MODEL[@ADDRESS]",
             "Simulate this module (see below); repeat it for more");
  repeatable("--firmware", words.firmware, "VERSION",
             "Let the --module before this say that it has such firmware: 1.09");
  repeatable("--as", words.as, "FILE",
             "Let the --module before this be like one that was measured (see below)");
  app.add_option("--bench", words.bench,
                 "Simulate the modules of this file, and what their motors drive (see below)")
      ->type_name("FILE");
  repeatable("--pty", words.options.ptys, "PATH",
             "Serve them on a pseudo terminal, and make PATH a link to it");
  repeatable("--usb-pty", words.usb_ptys, "[ADDRESS=]PATH",
             "Serve one of them as by its USB port on a pseudo terminal (see below)");
  repeatable("--usb", words.usb_devices, "[ADDRESS=][gd32|mk20]",
             "Let one of them be a USB device of this computer (see below)")
      ->expected(0, 1);
  repeatable("--can", words.options.can_interfaces, "INTERFACE",
             "Serve them on a CAN interface of Linux, such as vcan0");
  repeatable("--tcp", words.tcp, "HOST:PORT",
             "Serve them to TCP clients; port 0 takes any that is free");
  app.add_option("--eeprom", words.options.eeprom_folder,
                 "Remember what the modules store, in a file for each in this folder")
      ->type_name("DIR");
  app.add_option(
         "--pace", words.pace,
         "Make ports as slow as lines and modules are, at BAUD or at the modules' own rates")
      ->type_name("[BAUD]")
      ->expected(0, 1);
  app.add_flag("--echo", words.options.wires.echo,
               "Serial lines: let the host hear what it says, as some adapters do");
  app.add_option("--noise", words.options.wires.noise,
                 "Serial lines: how likely a byte gets a wrong bit, such as 0.001")
      ->type_name("RATE");
  app.add_option("--seed", words.options.wires.seed,
                 "Draw what is random, noise and how long USB takes, from this (default 0)")
      ->type_name("N");
  app.add_option("--gateway", words.options.gateway,
                 "Serve them by a tmcld in this process, with this configuration, in virtual time "
                 "(see below)")
      ->type_name("FILE");
  app.add_option("--replay", words.options.replay,
                 "Ask the modules what FILE has recorded, and compare what they answer (see below)")
      ->type_name("FILE");
  app.add_option("--debug", words.options.debug,
                 "Execute the program of FILE on the module command by command (see below)")
      ->type_name("FILE");
  app.add_flag("--console", words.options.console,
               "Take commands on standard input: loads, switches, inputs (see below)");
}

using OfModules = std::vector<std::optional<std::string>>;

// Which of these options stands behind which --module.
tl::expected<void, std::string> sort(const CLI::App& app, const std::string& name,
                                     const std::vector<std::string>& texts,
                                     const std::vector<std::string>& modules,
                                     OfModules& of_module) {
  auto text = texts.begin();
  for (const auto* option : app.parse_order()) {
    if (option->get_name() == "--module") of_module.emplace_back();
    if (option->get_name() != name) continue;
    const auto named = name + " " + *text;
    if (of_module.empty()) {
      return tl::unexpected(named +
                            " stands before any --module: put it behind the one it is for.");
    }
    auto& given = of_module.back();
    if (given) {
      return tl::unexpected(named + " is one too many: --module " + modules[of_module.size() - 1] +
                            " has " + name + " " + *given + " already.");
    }
    given = *text++;
  }
  return {};
}

// `modules` are those of the command line.
tl::expected<void, std::string> be_as(const OptionWords& words, std::span<ModuleSpec> modules) {
  for (std::size_t i = 0; i < std::min(modules.size(), words.as_of_module.size()); ++i) {
    const auto& path = words.as_of_module[i];
    if (!path) continue;
    const auto settings = read_module_file(*path, *modules[i].model);
    if (!settings) return tl::unexpected("--as: " + settings.error());
    modules[i].settings = *settings;
  }
  return {};
}

// `modules` are those of the command line.
tl::expected<void, std::string> give_firmware(const OptionWords& words,
                                              std::span<ModuleSpec> modules) {
  const auto& of_module = words.firmware_of_module;
  for (std::size_t i = 0; i < std::min(modules.size(), of_module.size()); ++i) {
    const auto& text = of_module[i];
    if (!text) continue;
    modules[i].settings.firmware = parse_release(*text);
    if (modules[i].settings.firmware) continue;
    return tl::unexpected("'" + *text + "'" + std::string(no_release) + ".");
  }
  return {};
}

// The modules of the file, then those of the command line.
tl::expected<std::vector<ModuleSpec>, std::string> all_modules(const OptionWords& words) {
  std::vector<BenchModule> bench;
  if (!words.bench.empty()) {
    auto file = read_bench_file(words.bench);
    if (!file) return tl::unexpected(file.error());
    bench = std::move(*file);
  }
  std::vector<std::string> texts;
  for (const auto& module : bench) texts.push_back(module.spec);
  texts.insert(texts.end(), words.modules.begin(), words.modules.end());
  auto modules = parse_modules(texts);
  if (!modules) return modules;
  for (std::size_t i = 0; i < bench.size(); ++i) {
    (*modules)[i].stages = std::move(bench[i].axes);
    (*modules)[i].settings = bench[i].settings;
    (*modules)[i].surroundings = bench[i].surroundings;
  }
  const auto on_command_line = std::span(*modules).subspan(bench.size());
  const auto measured = be_as(words, on_command_line);
  if (!measured) return tl::unexpected(measured.error());
  const auto given = give_firmware(words, on_command_line);
  if (!given) return tl::unexpected(given.error());
  return modules;
}

// A port by USB has the pace that USB has, and no wires.
tl::expected<void, std::string> check_wires(OptionWords& words, bool has_pace) {
  auto& wires = words.options.wires;
  const bool has_line =
      !words.options.ptys.empty() || !words.tcp.empty() || !words.options.gateway.empty();
  if ((wires.echo || wires.noise != 0) && !has_line)
    return tl::unexpected<std::string>(
        "--echo and --noise are of serial lines: --pty PATH, --tcp HOST:PORT.");
  if (!(wires.noise >= 0 && wires.noise <= 1))
    return tl::unexpected<std::string>("--noise is 0 to 1, such as 0.001: one byte of a thousand.");
  wires.has_pace = has_pace;
  if (words.pace.empty()) return {};
  constexpr std::uint32_t fastest = 4'000'000;
  wires.baud = parse_number<std::uint32_t>(words.pace).value_or(0);
  if (wires.baud == 0 || wires.baud > fastest)
    return tl::unexpected("--pace " + words.pace + " is no baud rate, such as 9600 or 115200.");
  return {};
}

tl::expected<void, std::string> check_debug(const OptionWords& words, bool has_port) {
  const auto& options = words.options;
  if (has_port || options.console || !options.gateway.empty() || !options.replay.empty() ||
      !options.eeprom_folder.empty())
    return tl::unexpected<std::string>(
        "--debug takes no port, console, gateway, replay or EEPROM: its module is "
        "switched on anew to go back.");
  return {};
}

tl::expected<void, std::string> check_ways(const OptionWords& words, bool has_port) {
  const auto& options = words.options;
  if (!options.debug.empty()) return check_debug(words, has_port);
  const bool replays = !options.replay.empty();
  const bool has_gateway = !options.gateway.empty();
  if (replays && (has_port || options.console || has_gateway))
    return tl::unexpected<std::string>(
        "--replay takes no port, no console and no gateway: it asks by itself.");
  if (has_gateway && has_port)
    return tl::unexpected<std::string>(
        "--gateway takes no port: a host there would not have its virtual time.");
  if (!replays && !has_gateway && !has_port) {
    return tl::unexpected<std::string>(
        "no way to reach the modules. Add one: --pty PATH, --usb-pty PATH, --usb, "
        "--can INTERFACE or --tcp HOST:PORT");
  }
  return {};
}

tl::expected<Options, std::string> check(OptionWords words, bool has_pace) {
  if (words.modules.empty() && words.bench.empty()) {
    return tl::unexpected<std::string>("no module to simulate. Add one: --module TMCM-1110");
  }
  const auto& ports = words.options;
  const bool has_usb = !words.usb_ptys.empty() || !words.usb_devices.empty();
  const bool has_serial = !ports.ptys.empty() || !words.tcp.empty();
  if (auto checked = check_ways(words, has_usb || has_serial || !ports.can_interfaces.empty());
      !checked)
    return tl::unexpected(checked.error());
  if (auto checked = check_wires(words, has_pace); !checked) return tl::unexpected(checked.error());
  auto modules = all_modules(words);
  if (!modules) return tl::unexpected(modules.error());
  if (modules->empty()) return tl::unexpected(words.bench + " describes no module.");
  if (!ports.debug.empty() && modules->size() != 1)
    return tl::unexpected<std::string>("--debug takes one module.");
  words.options.modules = std::move(*modules);
  auto usb_ptys = parse_usb_ports(words.usb_ptys, words.options.modules);
  if (!usb_ptys) return tl::unexpected(usb_ptys.error());
  words.options.usb_ptys = std::move(*usb_ptys);
  auto usb_devices = parse_usb_devices(words.usb_devices, words.options.modules);
  if (!usb_devices) return tl::unexpected(usb_devices.error());
  words.options.usb_devices = std::move(*usb_devices);
  for (const auto& text : words.tcp) {
    const auto endpoint = tmcl::sim::parse_endpoint(text);
    if (!endpoint) {
      return tl::unexpected("'" + text + "' is not HOST:PORT, such as 127.0.0.1:4001.");
    }
    words.options.tcp_endpoints.push_back(*endpoint);
  }
  return words.options;
}

}  // namespace

tl::expected<std::variant<Options, Information>, std::string> parse_options(
    int argc, const char* const* argv) {
  CLI::App app(description, "tmclsim");
  OptionWords words;
  describe(app, words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return Information{app.help() + "\n"};
  } catch (const CLI::CallForVersion& version) {
    return Information{std::string(version.what()) + "\n"};
  } catch (const CLI::ParseError& error) {
    return tl::unexpected(error.what());
  }
  if (const auto rest = app.remaining(); !rest.empty()) {
    return tl::unexpected(unexpected_word(rest.front()));
  }
  auto sorted = sort(app, "--firmware", words.firmware, words.modules, words.firmware_of_module);
  if (sorted) sorted = sort(app, "--as", words.as, words.modules, words.as_of_module);
  if (!sorted) return tl::unexpected(sorted.error());
  return check(std::move(words), app.count("--pace") > 0);
}

}  // namespace tmclsim
