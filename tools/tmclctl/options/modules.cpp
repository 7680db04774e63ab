// Everything that is said of modules as a whole.
#include "grammar.hpp"
#include "help_text.hpp"

namespace tmclctl {

void add_raw(Grammar& grammar) {
  auto raw = grammar.verb<verb::Raw>("raw", "Send one command as it is", help_text::raw);
  raw.option("--bus", "NAME", "Which of tmcld's buses; needed if there are several",
             text(raw->bus));
  raw.word("ADDRESS", "The module's address", number(raw->address, 0, greatest_address));
  raw.word("COMMAND", "Name such as GAP, or number", text(raw->command));
  raw.word("TYPE", "Name such as ABS or a parameter's, or number", text(raw->type));
  raw.word("MOTOR", "Motor or bank", number(raw->motor));
  raw.word("VALUE", "May be negative", number(raw->value));
}

}  // namespace tmclctl
