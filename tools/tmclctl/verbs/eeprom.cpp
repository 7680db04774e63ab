// store, restore.
#include "ask.hpp"

namespace tmclctl {

namespace {

constexpr const char* store_help = R"(
Keeps the value that the parameter has now: the module starts with it from then on. Only some
parameters can be stored: 'tmclctl params AXIS' shows RWE in its column ACCESS.

  tmclctl set x max_velocity 1500
  tmclctl store x max_velocity
)";

constexpr const char* restore_help = R"(
Sets the parameter to the value that was stored last, as the next start of the module would.

  tmclctl restore x max_velocity
)";

}  // namespace

void add_eeprom(Grammar& grammar) {
  auto store = ask(grammar, "store", access::acts, "parameter.store",
                   "Keep a parameter's value when the module loses power", store_help);
  store.axis(store->axis);
  add_parameter(store);
  auto restore = ask(grammar, "restore", access::acts, "parameter.restore",
                     "Take back what was stored", restore_help);
  restore.axis(restore->axis);
  add_parameter(restore);
}

}  // namespace tmclctl
