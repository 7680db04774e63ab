// A program outside the tree that uses the installed library.

#include <iostream>

#include "tmcl/blocking.hpp"
#include "tmcl/bus.hpp"

int main() {
  const auto bus = tmcl::blocking::Bus::open("serial:/dev/no-such-port");
  std::cout << describe(bus.error()) << '\n';
  return bus.error().code == tmcl::Errc::link_open_failed ? 0 : 1;
}
