// global: parameters of modules as a whole.
#include "ask.hpp"

namespace tmclctl {

namespace {

constexpr const char* global_help = R"(
Names are those of bank 0. Parameters 64 to 127 of bank 0 are stored at once; some, such as the
address, take effect at once, too, or after a reset.

  tmclctl global get 1 can_bit_rate
  tmclctl global set bench:1 5 4711 --bank 2     user variable 5
  tmclctl global store 1 5 --bank 2              its value now is what it starts with ...
  tmclctl global restore 1 5 --bank 2            ... and has again
)";

constexpr std::int32_t greatest_bank = 255;

AskForm add_global(Grammar& grammar, const Form& group, const std::string& name,
                   const Access& access, const char* method, const std::string& description) {
  auto form = ask(grammar, group, name, access, method, description, global_help);
  form.module(form->module);
  add_parameter(form);
  form.option("--bank", "N", "Bank of the parameter (default 0); user variables are in bank 2",
              number(form->bank, 0, greatest_bank));
  return form;
}

}  // namespace

void add_globals(Grammar& grammar) {
  const auto global = grammar.group("global", "Parameters of modules as a whole", global_help);
  add_global(grammar, global, "get", access::reads, "global.get", "Print one bare value");
  auto set = add_global(grammar, global, "set", access::acts, "global.set", "Set it");
  set.word("VALUE", "The new value", number(set->value));
  add_global(grammar, global, "store", access::acts, "global.store",
             "Keep it when the module loses power");
  add_global(grammar, global, "restore", access::acts, "global.restore",
             "Take back what was stored");
}

}  // namespace tmclctl
