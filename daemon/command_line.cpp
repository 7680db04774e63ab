// The only file of the daemon that knows the command-line library: it takes long to compile.
#include "command_line.hpp"

#include <CLI/CLI.hpp>

#include <iostream>
#include <string>

namespace tmcld {
namespace {

constexpr auto description =
    "tmcld owns the buses that TMCM modules are on and lets many programs use their axes safely.\n"
    "Clients talk to it through a unix socket; 'tmclctl' is one.";

constexpr auto footer = R"(The least configuration file:

    [daemon]
    socket = "/run/tmcld/tmcld.sock"

    [[bus]]
    name = "bench"
    link = "serial:/dev/ttyACM0@115200"

    [[axis]]
    name = "x"
    bus = "bench"
    address = 1
    motor = 0

Links: serial:DEVICE@BAUD, usb:PORT, can:INTERFACE, tcp:HOST:PORT. Below the folder that tmcld was installed
to, such as /usr/local, share/doc/tmcl/examples/tmcld.toml explains every key, and
share/doc/tmcl/PROTOCOL.md what clients say to it.

Exit codes: 0 ended as asked, 1 failure while running, 2 bad command line or configuration.

Try it without hardware:
    tmclsim --module TMCM-1110@1 --pty /tmp/tmcl
    tmcld --config FILE            (with link = "serial:/tmp/tmcl@115200")
    tmclctl --socket SOCKET move x 51200)";

ExitCode complain(const std::string& what) {
  std::cerr << "tmcld: " << what
            << "\n  'tmcld --help' shows the least configuration file, and how to try it without "
               "hardware\n";
  return ExitCode{exit_code::bad_usage};
}

}  // namespace

std::variant<CommandLine, ExitCode> parse_command_line(int argc, const char* const* argv) {
  CLI::App app(description, "tmcld");
  app.footer(footer);
  app.set_version_flag("--version", std::string("tmcld ") + TMCL_VERSION);
  CommandLine result;
  app.add_option("-c,--config", result.config_file, "the configuration file, in TOML")
      ->type_name("FILE")
      ->capture_default_str();
  app.add_flag("--check", result.only_check,
               "check the configuration file, say what is in it, and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked);
    return ExitCode{exit_code::ok};
  } catch (const CLI::ExtrasError& error) {
    const auto word = app.remaining().empty() ? std::string{} : app.remaining().front();
    if (word.empty() || word.starts_with('-')) return complain(error.what());
    return complain("'" + word +
                    "' is one word too many; a configuration file is given as --config " + word);
  } catch (const CLI::ParseError& error) {
    return complain(error.what());
  }
  return result;
}

}  // namespace tmcld
