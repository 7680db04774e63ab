// ports: what this computer has that may lead to modules.
#include <fmt/format.h>

#include "output/print.hpp"
#include "tmcl/ports.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

json::value text_or_null(const std::string& text) {
  return text.empty() ? json::value() : json::value(text);
}

json::value to_json(const std::optional<tmcl::UsbDeviceInfo>& device) {
  if (!device) return nullptr;
  return json::object{{"port", device->port},
                      {"vendor_id", fmt::format("{:04x}", device->vendor)},
                      {"product_id", fmt::format("{:04x}", device->product)},
                      {"manufacturer", text_or_null(device->manufacturer)},
                      {"product", text_or_null(device->product_name)},
                      {"serial", text_or_null(device->serial)}};
}

json::object to_json(const tmcl::Port& port, const std::string& holder) {
  return {{"link", link_to(port)},
          {"device", text_or_null(port.device)},
          {"driver", text_or_null(port.driver)},
          {"by_path", text_or_null(port.by_path)},
          {"usb", to_json(port.usb)},
          {"is_module", is_module(port)},
          {"held_by", text_or_null(holder)}};
}

std::string what_is_behind(const tmcl::Port& port) {
  if (!port.usb) return port.driver;
  return describe(*port.usb) + (port.device.empty() ? " (no serial port of it now)" : "");
}

Result<ExitCode> run(const verb::Ports&, Output& output) {
  json::array array;
  Table table({"LINK", "USB PORT", "BEHIND IT", "MODULE", "HELD BY", "NAME THAT STAYS"});
  const auto ports = tmcl::list_ports();
  for (const auto& port : ports) {
    const auto holder = holder_of(port);
    array.push_back(to_json(port, holder));
    table.add({link_to(port), port.usb ? port.usb->port : "-", what_is_behind(port),
               is_module(port) ? "yes" : "?", holder.empty() ? "-" : holder,
               port.by_path.empty() ? "-" : port.by_path});
  }
  if (output.json) {
    print_json({{"ports", std::move(array)}}, output);
  } else if (ports.empty()) {
    output.err << "This computer has no serial port, and no module on USB that it can see.\n";
  } else {
    table.print(output);
  }
  return ExitCode::done;
}

constexpr const char* ports_help = R"(
Looks at what the kernel lists, and opens nothing. LINK is what --direct and the
configuration of tmcld take; 'usb:' with the USB port leads there as well, past the
serial port. Programs of other users cannot be seen holding a port unless they lock it.

  tmclctl ports
  tmclctl --direct auto scan                     the only module by USB that there is
)";

}  // namespace

void add_ports(Grammar& grammar) {
  grammar.verb<verb::Ports>("ports", access::offline("it opens no port"),
                            "List the serial ports and modules by USB of this computer", ports_help,
                            run);
}

}  // namespace tmclctl
