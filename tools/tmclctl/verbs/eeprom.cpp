// store, restore.
#include "ask.hpp"

namespace tmclctl {

namespace {

constexpr const char* store_help = R"(
Keeps the value that the parameter has now: the module starts with it from then on. Only some
parameters can be stored: 'tmclctl params AXIS' shows RWE in its column ACCESS.

  tmclctl set x max_velocity 1500
  tmclctl store x max_velocity
  tmclctl store x --all                          all settings of the axis, as they are now
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
  store.optional_word("PARAM", "Number or standard name", text(store->parameter));
  store.flag("--all", "All settings of the axis", store->all);
  store.object([](const verb::Ask& said, bool) {
    return said.parameter.empty() != said.all ? "say which parameter, or --all, and not both" : "";
  });
  auto restore = ask(grammar, "restore", access::acts, "parameter.restore",
                     "Take back what was stored", restore_help);
  restore.axis(restore->axis);
  add_parameter(restore);
}

}  // namespace tmclctl
