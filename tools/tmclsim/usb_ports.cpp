#include "usb_ports.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

namespace tmclsim {
namespace {

struct Named {
  std::optional<unsigned> address;
  std::string path;
};

// What stands before '=' and is no number belongs to the path.
Named split(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return {{}, text};
  unsigned address = 0;
  const auto* end = text.data() + equals;
  const auto [stop, error] = std::from_chars(text.data(), end, address);
  if (error != std::errc{} || stop != end) return {{}, text};
  return {address, text.substr(equals + 1)};
}

tl::expected<std::size_t, std::string> module_of(const Named& port, const std::string& text,
                                                 const std::vector<ModuleSpec>& modules) {
  if (!port.address && modules.size() == 1) return 0;
  if (!port.address) {
    return tl::unexpected("--usb-pty " + text + " does not say of which of the " +
                          std::to_string(modules.size()) + " modules: ADDRESS=" + text + ".");
  }
  const auto address = std::to_string(*port.address);
  const auto has_address = [&](const ModuleSpec& module) {
    return number(module.address) == *port.address;
  };
  const auto found = std::ranges::find_if(modules, has_address);
  if (found == modules.end())
    return tl::unexpected("--usb-pty " + text + ": no module has the address " + address + ".");
  if (std::ranges::count_if(modules, has_address) > 1)
    return tl::unexpected("--usb-pty " + text + ": several modules have the address " + address +
                          "; give them different ones.");
  return static_cast<std::size_t>(found - modules.begin());
}

}  // namespace

tl::expected<std::vector<UsbPort>, std::string> parse_usb_ports(
    const std::vector<std::string>& texts, const std::vector<ModuleSpec>& modules) {
  std::vector<UsbPort> ports;
  for (const auto& text : texts) {
    const auto named = split(text);
    if (named.path.empty())
      return tl::unexpected("--usb-pty " + text + " names no file, such as /tmp/tmcm.");
    const auto module = module_of(named, text, modules);
    if (!module) return tl::unexpected(module.error());
    if (std::ranges::find(ports, *module, &UsbPort::module) != ports.end())
      return tl::unexpected("--usb-pty " + text + ": the module has a USB port already.");
    ports.push_back({*module, named.path});
  }
  return ports;
}

}  // namespace tmclsim
