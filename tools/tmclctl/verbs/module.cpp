// info, reset, factory-reset.
#include "ask.hpp"

namespace tmclctl {

namespace {

constexpr const char* info_help = R"(
What the module does not tell is "-".

  tmclctl info 1
  tmclctl info bench:1
)";

constexpr const char* reset_help = R"(
The module starts anew, as after a loss of power: its motors stop, it forgets where they are, and its
parameters are those that were stored. It does not answer meanwhile.

  tmclctl reset 1
)";

constexpr const char* factory_reset_help = R"(
The module does not answer, and restarts. It may come back with another address and baud rate.

  tmclctl factory-reset 1 --yes
)";

}  // namespace

void add_module(Grammar& grammar) {
  auto info = ask(grammar, "info", access::reads, "module.info",
                  "Show what a module's firmware says of itself", info_help);
  info.module(info->module);
  auto reset = ask(grammar, "reset", access::acts, "module.reset", "Restart a module", reset_help);
  reset.module(reset->module);
  auto factory = ask(grammar, "factory-reset", access::acts, "module.factory_reset",
                     "Set everything in a module back to how it was delivered", factory_reset_help);
  factory.module(factory->module);
  factory.flag("--yes", "Really", factory->sure);
  factory.object(
      [](const verb::Ask& said, bool) {
        return said.sure ? "" : "all that is stored in the module would be lost: say --yes";
      },
      "Its address and its baud rate change too");
}

}  // namespace tmclctl
