// Finds the modules on a link and lists the parameters of their first motors by name.
//
//     02_scan_and_parameters serial:/dev/ttyACM0@115200

#include <iostream>

#include "tmcl/blocking.hpp"
#include "tmcl/parameter.hpp"

namespace {

void list_parameters(tmcl::blocking::Axis axis, const tmcl::Model& model) {
  for (const auto& parameter : axis_parameters(model)) {
    const auto value = axis.get(parameter.number);
    std::cout << "  " << parameter.number + 0 << ' ' << parameter.name << " = ";
    if (value) {
      std::cout << *value << ' ' << parameter.unit << '\n';
    } else {
      std::cout << describe(value.error()) << '\n';
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  auto bus = tmcl::blocking::Bus::open(argc > 1 ? argv[1] : "serial:/dev/ttyACM0@115200");
  if (!bus) {
    std::cerr << describe(bus.error()) << '\n';
    return 1;
  }

  const auto modules = bus->run(tmcl::verbs::scan({.first = 1, .last = 16}));
  if (!modules) {
    std::cerr << describe(modules.error()) << '\n';
    return 1;
  }
  for (const auto& found : *modules) {
    std::cout << "address " << number(found.address) << ": " << found.model << ", firmware "
              << to_string(found.version) << ", " << found.axes + 0 << " axes\n";
    const auto* model = tmcl::find_model(found.version.model);
    if (model != nullptr) list_parameters(bus->module(found.address).axis(0), *model);
  }
}
