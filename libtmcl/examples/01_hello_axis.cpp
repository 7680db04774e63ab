// Opens a link, moves a motor, waits until it has arrived.
//
//     01_hello_axis serial:/dev/ttyACM0@115200

#include <iostream>

#include "tmcl/blocking.hpp"

int main(int argc, char** argv) {
  const auto* link = argc > 1 ? argv[1] : "serial:/dev/ttyACM0@115200";
  auto bus = tmcl::blocking::Bus::open(link);
  if (!bus) {
    std::cerr << describe(bus.error()) << '\n';
    return 1;
  }

  auto axis = bus->module(tmcl::ModuleAddress{1}).axis(0);
  const auto target = axis.move_by(tmcl::Microsteps{20'000});
  if (!target) {
    std::cerr << describe(target.error()) << '\n';
    return 1;
  }
  std::cout << "on its way to " << target->value << '\n';

  const auto position = axis.wait_until_reached();
  if (!position) {
    std::cerr << describe(position.error()) << '\n';
    return 1;
  }
  std::cout << "stands at " << position->value << '\n';
}
