// Moves an axis of a running tmcld, beside all other programs that do: by its name, and in mm.
//
//     05_through_tmcld /run/tmcld/tmcld.sock

#include <iostream>

#include "tmcl/api/module.hpp"
#include "tmcl/client.hpp"

namespace {

int complain(const tmcl::client::Error& error) {
  std::cerr << error.message << "\n  " << error.hint << '\n';
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  auto daemon = tmcl::client::Caller::open(argc > 1 ? argv[1] : "/run/tmcld/tmcld.sock");
  if (!daemon) return complain(daemon.error());

  auto x = daemon->axis("x");
  const auto moved = x.move_to("2.5mm");
  if (!moved) return complain(moved.error());
  std::cout << "there in " << moved->predicted_s.value_or(0) << " s\n";

  const auto stands = x.wait();
  if (!stands) return complain(stands.error());
  std::cout << "stands at " << stands->position.value_or(0) << " mm\n";

  const auto speed = x.get("max_velocity");
  if (!speed) return complain(speed.error());
  std::cout << "goes at " << speed->value_in_unit.value_or(0) << " mm/s at most\n";

  // Every method of docs/PROTOCOL.md is a struct, and so is what it gives.
  const auto modules = daemon->call(tmcl::api::module::List{});
  if (!modules) return complain(modules.error());
  for (const auto& module : modules->modules)
    std::cout << module.bus << ' ' << module.address << " is " << module.state << '\n';

  // A distance that the unit does not fit is an error of the call, with a hint.
  const auto refused = x.move_by("90deg");
  std::cout << refused.error().message << '\n';
  return refused.error().name == "unknown_unit" ? 0 : 1;
}
