// Every example of docs/PROTOCOL.md, said to a real daemon on a simulated bus.
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>

#include "support/build_paths.hpp"
#include "system/tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

struct ExampleLine {
  int number;
  bool to_daemon;
  std::string text;
};

std::vector<ExampleLine> example_lines() {
  std::ifstream file(TMCL_SOURCE_DIR "/docs/PROTOCOL.md");
  std::vector<ExampleLine> lines;
  bool in_example = false;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.starts_with("```")) {
      in_example = line == "```jsonrpc";
    } else if (in_example) {
      EXPECT_TRUE(line.starts_with("> ") || line.starts_with("< ")) << "line " << number;
      lines.push_back({number, line[0] == '>', line.substr(2)});
    }
  }
  return lines;
}

/// `...` in the pattern stands for any text.
bool matches(std::string_view text, std::string_view pattern) {
  const auto gap = pattern.find("...");
  if (gap == std::string_view::npos) return text == pattern;
  if (!text.starts_with(pattern.substr(0, gap))) return false;
  text.remove_prefix(gap);
  pattern.remove_prefix(gap + 3);
  for (std::size_t skipped = 0; skipped <= text.size(); ++skipped) {
    if (matches(text.substr(skipped), pattern)) return true;
  }
  return false;
}

bool is_state(std::string_view line) {
  return line.find("\"method\":\"notify_state\"") != std::string_view::npos;
}

using TmcldProtocol = TmcldTest;

TEST_F(TmcldProtocol, EveryExampleIsTrue) {
  start_simulator_on_pty();
  write_config(pty_link(), "unit = \"mm\"\nscrew_pitch = 5\nsoft_limits = [-10, 300]\n");
  start_daemon();
  RpcClient client(socket(), false);
  const auto lines = example_lines();
  EXPECT_GT(lines.size(), 40U);
  for (const auto& line : lines) {
    SCOPED_TRACE("docs/PROTOCOL.md:" + std::to_string(line.number));
    if (line.to_daemon) {
      client.send_raw(line.text + "\n");
      continue;
    }
    auto got = client.read_line();
    // A subscription goes on telling: an example shows one of its states.
    while (got && is_state(*got) && !matches(*got, line.text)) got = client.read_line();
    ASSERT_TRUE(got);
    ASSERT_TRUE(matches(*got, line.text)) << *got;
  }
}

}  // namespace
}  // namespace tmcl::test
