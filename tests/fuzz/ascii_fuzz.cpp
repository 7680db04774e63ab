// The bytes as lines of the ASCII mode, as replies, and as what someone types into a terminal.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "require.hpp"
#include "sim/wire/ascii_terminal.hpp"
#include "tmcl/ascii.hpp"

namespace {

namespace ascii = tmcl::ascii;
using tmcl::fuzz::require;
using tmcl::sim::AsciiTerminal;

void as_line(std::string_view line) {
  const auto order = ascii::parse(line);
  if (!order) {
    require(!order.error().message.empty(), "there is a reason");
    require(order.error().column <= line.size() + 1, "in the line");
    require(!tmcl::is_success(order.error().status), "with a status that says no");
    return;
  }
  const auto written = ascii::to_line(*order);
  require(written.has_value(), "what was read can be written");
  const auto again = ascii::parse(*written);
  require(again && *again == *order, "and read again");
}

void as_reply(std::string_view text) {
  const auto reply = ascii::parse_reply(text);
  if (!reply) return;
  require(ascii::parse_reply(ascii::to_text(*reply)) == reply, "a reply comes back");
}

void as_typing(std::string_view text) {
  AsciiTerminal terminal;
  for (const auto echo : {AsciiTerminal::Echo::characters, AsciiTerminal::Echo::lines}) {
    for (const auto c : text) {
      const auto heard = terminal.push(static_cast<std::uint8_t>(c), 1, echo);
      require(heard.echo.size() <= ascii::longest_line + 2, "the echo is bounded");
      require(!heard.line || heard.line->size() <= ascii::longest_line + 1, "and so is the line");
      if (heard.line) as_line(*heard.line);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  as_line(text);
  as_reply(text);
  as_typing(text);
  return 0;
}
