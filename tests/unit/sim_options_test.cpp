// The command line of tmclsim: what it says of each module.
#include <gmock/gmock.h>

#include <fstream>
#include <string>
#include <vector>

#include "support/temp_path.hpp"
#include "tools/tmclsim/options.hpp"

namespace tmclsim {
namespace {

using testing::HasSubstr;
using tmcl::sim::FirmwareRelease;

tl::expected<Options, std::string> parse(std::vector<std::string> words) {
  words.insert(words.begin(), "tmclsim");
  std::vector<const char*> pointers;
  for (const auto& word : words) pointers.push_back(word.c_str());
  return parse_options(static_cast<int>(pointers.size()), pointers.data())
      .map([](const auto& parsed) { return std::get<Options>(parsed); });
}

tl::expected<Options, std::string> parse_on_a_pty(std::vector<std::string> words) {
  words.insert(words.end(), {"--pty", "/tmp/bus"});
  return parse(std::move(words));
}

std::string error_of(const std::vector<std::string>& words) {
  const auto parsed = parse_on_a_pty(words);
  if (parsed) return "";
  return parsed.error();
}

TEST(SimOptions, AFirmwareIsThatOfTheModuleBefore) {
  const auto parsed = parse_on_a_pty({"--module", "TMCM-1110", "--firmware", "1.09", "--module",
                                      "TMCM-3110", "--module=TMCM-6110", "--firmware=9.99"});
  ASSERT_TRUE(parsed) << parsed.error();
  const auto& modules = parsed->modules;
  ASSERT_EQ(modules.size(), 3U);
  EXPECT_EQ(modules[0].settings.firmware, (FirmwareRelease{1, 9}));
  EXPECT_EQ(modules[1].settings.firmware, std::nullopt);
  EXPECT_EQ(modules[2].settings.firmware, (FirmwareRelease{9, 99}));
}

TEST(SimOptions, AGatewayTakesNoPort) {
  EXPECT_THAT(error_of({"--module", "TMCM-1110", "--gateway", "tmcld.toml"}),
              HasSubstr("--gateway takes no port"));
}

TEST(SimOptions, ADebuggerTakesNoPortAndOneModule) {
  EXPECT_THAT(error_of({"--module", "TMCM-1110", "--debug", "loop.tmc"}),
              HasSubstr("--debug takes no port"));
  const auto one = parse({"--module", "TMCM-1110", "--debug", "loop.tmc"});
  ASSERT_TRUE(one) << one.error();
  EXPECT_EQ(one->debug, "loop.tmc");
  const auto two = parse({"--module", "TMCM-1110", "--module", "TMCM-1110", "--debug", "loop.tmc"});
  ASSERT_FALSE(two);
  EXPECT_THAT(two.error(), HasSubstr("--debug takes one module"));
}

TEST(SimOptions, AFirmwareHasAModuleOfItsOwn) {
  EXPECT_THAT(error_of({"--firmware", "1.09", "--module", "TMCM-1110"}),
              HasSubstr("--firmware 1.09 stands before any --module"));
  EXPECT_THAT(error_of({"--module", "TMCM-1110", "--firmware", "1.09", "--firmware", "1.10"}),
              HasSubstr("--firmware 1.10 is one too many: --module TMCM-1110 has --firmware 1.09"));
}

TEST(SimOptions, AModuleIsLikeTheOneOfAFileAndStillHasTheFirmwareThatIsSaid) {
  const auto path = tmcl::test::temp_path("module.toml");
  std::ofstream(path) << "[module]\nmodel = \"TMCM-1110\"\nfirmware_version = \"1.09\"\n"
                         "order = \"pulse_first\"\n";
  const auto parsed = parse_on_a_pty({"--module", "TMCM-1110", "--as", path.c_str(), "--module",
                                      "TMCM-1110", "--as", path.c_str(), "--firmware", "1.11"});
  ASSERT_TRUE(parsed) << parsed.error();
  const auto& modules = parsed->modules;
  EXPECT_EQ(modules[0].settings.firmware, (FirmwareRelease{1, 9}));
  EXPECT_EQ(modules[1].settings.firmware, (FirmwareRelease{1, 11}));
  for (const auto& module : modules) EXPECT_EQ(module.settings.traits.find(tmcl::Trait::order), 1);
  EXPECT_THAT(error_of({"--module", "TMCM-1140", "--as", path.c_str()}),
              HasSubstr("this is a TMCM-1110, not a TMCM-1140"));
  EXPECT_THAT(error_of({"--as", path.c_str(), "--module", "TMCM-1110"}),
              HasSubstr("stands before any --module"));
}

TEST(SimOptions, AFirmwareIsAVersion) {
  for (const auto* wrong : {"1", "1.9", "1.095", "10.00", "256.00", "1110V109", "x.yz"}) {
    EXPECT_THAT(
        error_of({"--module", "TMCM-1110", "--firmware", wrong}),
        HasSubstr("'" + std::string(wrong) + "' is not a version: it is MAJOR.MINOR, 0.00"));
  }
  EXPECT_THAT(error_of({"--module", "TMCM-1110", "--firmwar", "1.09"}),
              HasSubstr("Did you mean '--firmware'?"));
}

}  // namespace
}  // namespace tmclsim
