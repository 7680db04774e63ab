#include "usb_ports.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "number_text.hpp"

namespace tmclsim {
namespace {

using Failure = tl::unexpected<std::string>;

struct Named {
  std::string option;  // as it was typed
  std::optional<unsigned> address;
  std::string rest;
};

// What stands before '=' and is no number belongs to the rest.
Named split(const std::string& option, const std::string& text) {
  const auto typed = text.empty() ? option : option + " " + text;
  const auto equals = text.find('=');
  if (equals == std::string::npos) return {typed, {}, text};
  const auto address = parse_number<unsigned>(std::string_view(text).substr(0, equals));
  return {typed, address, address ? text.substr(equals + 1) : text};
}

tl::expected<std::size_t, std::string> module_of(const Named& port,
                                                 const std::vector<ModuleSpec>& modules) {
  if (!port.address && modules.size() == 1) return 0;
  if (!port.address) {
    return Failure(port.option + " does not say of which of the " + std::to_string(modules.size()) +
                   " modules: put its address before it, as in " +
                   port.option.substr(0, port.option.find(' ')) +
                   " 1=" + (port.rest.empty() ? "gd32" : port.rest) + ".");
  }
  const auto address = std::to_string(*port.address);
  const auto has_address = [&](const ModuleSpec& module) {
    return number(module.address) == *port.address;
  };
  const auto found = std::ranges::find_if(modules, has_address);
  if (found == modules.end())
    return Failure(port.option + ": no module has the address " + address + ".");
  if (std::ranges::count_if(modules, has_address) > 1)
    return Failure(port.option + ": several modules have the address " + address +
                   "; give them different ones.");
  return static_cast<std::size_t>(found - modules.begin());
}

// Adds a port to the others; a module has one.
template <typename Port>
tl::expected<void, std::string> add(std::vector<Port>& ports, const Named& named, Port port,
                                    const std::vector<ModuleSpec>& modules) {
  const auto module = module_of(named, modules);
  if (!module) return Failure(module.error());
  if (std::ranges::find(ports, *module, &Port::module) != ports.end())
    return Failure(named.option + ": the module has a USB port already.");
  port.module = *module;
  ports.push_back(std::move(port));
  return {};
}

}  // namespace

tl::expected<std::vector<UsbPort>, std::string> parse_usb_ports(
    const std::vector<std::string>& texts, const std::vector<ModuleSpec>& modules) {
  std::vector<UsbPort> ports;
  for (const auto& text : texts) {
    const auto named = split("--usb-pty", text);
    if (named.rest.empty()) return Failure(named.option + " names no file, such as /tmp/tmcm.");
    const auto added = add(ports, named, UsbPort{0, named.rest}, modules);
    if (!added) return Failure(added.error());
  }
  return ports;
}

tl::expected<std::vector<UsbDevicePort>, std::string> parse_usb_devices(
    const std::vector<std::string>& texts, const std::vector<ModuleSpec>& modules) {
  using tmcl::sim::UsbLayout;
  std::vector<UsbDevicePort> ports;
  for (const auto& text : texts) {
    auto named = split("--usb", text);
    if (const auto address = parse_number<unsigned>(named.rest))
      named = {named.option, address, ""};
    const bool is_known = named.rest.empty() || named.rest == "gd32" || named.rest == "mk20";
    if (!is_known) {
      return Failure(named.option + ": '" + named.rest +
                     "' is neither gd32, for a newer module, nor mk20, for an older one.");
    }
    const auto layout = named.rest == "mk20" ? UsbLayout::mk20 : UsbLayout::gd32;
    const auto added = add(ports, named, UsbDevicePort{0, layout}, modules);
    if (!added) return Failure(added.error());
  }
  return ports;
}

}  // namespace tmclsim
