// A program outside the tree that speaks to tmcld by the installed library.

#include <iostream>

#include "tmcl/client.hpp"

int main() {
  const auto daemon = tmcl::client::Caller::open("/no/such/directory/tmcld.sock");
  const auto move = tmcl::api::to_json(tmcl::api::axis::MoveTo{.axis = "x", .position = "25mm"});
  if (move.at("position").as_string() != "25mm") return 1;
  std::cout << daemon.error().message << '\n' << daemon.error().hint << '\n';
  return daemon.error().name == tmcl::client::error_name::unreachable ? 0 : 1;
}
