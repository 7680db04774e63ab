/// The command line of tmclsim.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "module_spec.hpp"
#include "sim/ports/endpoint.hpp"
#include "usb_ports.hpp"

namespace tmclsim {

/// How slow, and how bad, the wires are.
struct Wires {
  bool has_pace = false;
  std::uint32_t baud = 0;  ///< Of serial lines; 0: the modules' own, each.
  bool echo = false;
  double noise = 0;
  std::uint64_t seed = 0;  ///< Of whatever is drawn.
};

struct Options {
  std::vector<ModuleSpec> modules;
  std::vector<std::string> ptys;
  std::vector<UsbPort> usb_ptys;
  std::vector<UsbDevicePort> usb_devices;
  std::vector<std::string> can_interfaces;
  std::vector<tmcl::sim::Endpoint> tcp_endpoints;
  Wires wires;
  bool console = false;
  std::string gateway;        ///< A configuration of tmcld, for one in virtual time; empty: none.
  std::string debug;          ///< The text of a program to debug; empty: none.
  std::string replay;         ///< A file with recorded traffic; empty: none.
  std::string eeprom_folder;  ///< Empty if modules forget everything at the end.
};

/// What --help or --version is answered with.
struct Information {
  std::string text;
};

/// The error: a sentence with its full stop, of one or two lines.
tl::expected<std::variant<Options, Information>, std::string> parse_options(
    int argc, const char* const* argv);

}  // namespace tmclsim
