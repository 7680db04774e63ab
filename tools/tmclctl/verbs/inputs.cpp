// input, output.
#include "ask.hpp"

namespace tmclctl {

namespace {

constexpr std::int32_t greatest_port = 255;

constexpr const char* input_help = R"(
Prints one bare value. Port 255 of bank 0 is all digital inputs, a bit each.

  tmclctl input 1 0
  tmclctl input 1 0 --bank 1                     as the converter gives it
)";

constexpr const char* output_help = R"(
Without a VALUE it prints one bare value: what the output is set to.

  tmclctl output 1 0 1                           switch it on
  tmclctl output 1 0
)";

}  // namespace

void add_inputs(Grammar& grammar) {
  auto input =
      ask(grammar, "input", access::reads, "io.get", "Read an input of a module", input_help);
  input.module(input->module);
  input.word("PORT", "Its number", number(input->port, 0, greatest_port));
  input.option("--bank", "N", "0 digital (default), 1 analog, 2 the state of an output",
               number(input->bank, 0, 2));
  auto output = ask(grammar, "output", access::acts, "io.get",
                    "Set an output of a module, or read it", output_help);
  constexpr std::int32_t digital_outputs = 2;
  output->bank = digital_outputs;
  output.module(output->module);
  output.word("PORT", "Its number", number(output->port, 0, greatest_port));
  output.optional_word("VALUE", "0 or 1; without it, the output is read",
                       [output](const std::string& text) {
                         output->method = "io.set";
                         output->bank.reset();
                         return number(output->value)(text);
                       });
}

}  // namespace tmclctl
