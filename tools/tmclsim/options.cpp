#include "options.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <string_view>

#include "tmcl/nearest.hpp"

namespace tmclsim {
namespace {

constexpr auto known_options =
    std::to_array<std::string_view>({"--module", "--pty", "--can", "--tcp", "--help", "--version"});

constexpr auto description =
    "Simulates TMCL modules: what talks to a module on a wire can talk to this instead.\n"
    "The motors ramp as the real chip's do, in real time. Ends with Ctrl-C.";

constexpr auto explanation = R"(
MODEL is TMCM-1110, TMCM-3110 or TMCM-6110 (one, three or six motors with the ramps of a TMC429),
TMCM-142 or PD-146 (one motor, TMC457) or TMCM-6212 (six motors, sixPoint ramps). ADDRESS is 1 to
255, on serial lines and on CAN alike; without it a module gets the next free one from 1 on. Every
port reaches every module, and a module answers by the port that asked. Ports can be repeated as
well.

Examples
  One motor on a serial port that programs open as /tmp/tmcm:
      tmclsim --module TMCM-1110 --pty /tmp/tmcm
  Two modules on one line, at addresses 1 and 7, reached over TCP as well:
      tmclsim --module TMCM-1110@1 --module TMCM-6110@7 --pty /tmp/tmcm --tcp 127.0.0.1:4001
  A module on a virtual CAN bus:
      sudo ip link add dev vcan0 type vcan && sudo ip link set up vcan0
      tmclsim --module TMCM-3110 --can vcan0

When all is set up it prints a line for each module and each port, and then "ready".
Exit status: 0 ended as asked, 1 a port could not be opened, 2 the command line is wrong.)";

EarlyExit wrong(const std::string& sentence) {
  return {2, "tmclsim: " + sentence + "\nSee tmclsim --help.\n"};
}

EarlyExit unexpected_word(const std::string& word) {
  if (!word.starts_with("-")) return wrong("'" + word + "' belongs to no option.");
  const auto name = word.substr(0, word.find('='));
  return wrong("there is no option '" + name + "'." + tmcl::did_you_mean(name, known_options));
}

struct Words {
  std::vector<std::string> modules;
  std::vector<std::string> tcp;
  Options options;
};

void describe(CLI::App& app, Words& words) {
  app.allow_extras();  // so that we can say what was meant instead
  app.set_version_flag("--version", "tmclsim " TMCL_VERSION, "Print the version and exit");
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.footer(explanation);
  const auto repeatable = [&](const char* name, auto& target, const char* type, const char* help) {
    app.add_option(name, target, help)
        ->type_name(type)
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  repeatable("--module", words.modules, "MODEL[@ADDRESS]",
             "Simulate this module (see below); repeat it for more");
  repeatable("--pty", words.options.ptys, "PATH",
             "Serve them on a pseudo terminal, and make PATH a link to it");
  repeatable("--can", words.options.can_interfaces, "INTERFACE",
             "Serve them on a CAN interface of Linux, such as vcan0");
  repeatable("--tcp", words.tcp, "HOST:PORT",
             "Serve them to TCP clients; port 0 takes any that is free");
}

tl::expected<Options, EarlyExit> check(Words words) {
  if (words.modules.empty()) {
    return tl::unexpected(wrong("no module to simulate. Add one: --module TMCM-1110"));
  }
  const auto& ports = words.options;
  if (ports.ptys.empty() && ports.can_interfaces.empty() && words.tcp.empty()) {
    return tl::unexpected(
        wrong("no way to reach the modules. Add one: --pty PATH, --can INTERFACE "
              "or --tcp HOST:PORT"));
  }
  auto modules = parse_modules(words.modules);
  if (!modules) return tl::unexpected(wrong(modules.error()));
  words.options.modules = std::move(*modules);
  for (const auto& text : words.tcp) {
    const auto endpoint = tmcl::sim::parse_endpoint(text);
    if (!endpoint) {
      return tl::unexpected(wrong("'" + text + "' is not HOST:PORT, such as 127.0.0.1:4001."));
    }
    words.options.tcp_endpoints.push_back(*endpoint);
  }
  return words.options;
}

}  // namespace

tl::expected<Options, EarlyExit> parse_options(int argc, const char* const* argv) {
  CLI::App app(description, "tmclsim");
  Words words;
  describe(app, words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return tl::unexpected(EarlyExit{0, app.help() + "\n"});
  } catch (const CLI::CallForVersion& version) {
    return tl::unexpected(EarlyExit{0, std::string(version.what()) + "\n"});
  } catch (const CLI::ParseError& error) {
    return tl::unexpected(wrong(error.what()));
  }
  if (const auto rest = app.remaining(); !rest.empty()) {
    return tl::unexpected(unexpected_word(rest.front()));
  }
  return check(std::move(words));
}

}  // namespace tmclsim
