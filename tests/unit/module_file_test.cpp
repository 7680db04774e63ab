// What was measured of one module: its traits, and the file that has them.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tmcl/module_traits.hpp"
#include "tools/tmclsim/module_file.hpp"

namespace tmclsim {
namespace {

using namespace tmcl;  // the traits
using tmcl::sim::ModuleSettings;

TEST(Traits, StandInTheTableInTheirOrderWithWordsOfTheirOwn) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < trait_count; ++i) {
    const auto& info = trait_table()[i];
    EXPECT_EQ(index_of(info.trait), i) << info.name;
    names.insert(info.name);
    std::set<std::string_view> words(info.variants.begin(), info.variants.end());
    EXPECT_EQ(words.size(), info.variants.size()) << info.name;
    for (std::size_t variant = 0; variant < info.variants.size(); ++variant)
      EXPECT_EQ(parse_variant(info, info.variants[variant]), variant) << info.name;
  }
  EXPECT_EQ(names.size(), trait_count);
}

TEST(Traits, AreAsUsualForTheModelUntilTheyAreKnown) {
  const auto& old = *find_model("TMCM-1110");
  const auto& newer = *find_model("TMCM-1276");
  ModuleTraits traits;
  EXPECT_TRUE(traits.empty());
  EXPECT_EQ(traits.get<RelativeFrom>(Trait::relative_from, old), RelativeFrom::actual);
  EXPECT_EQ(traits.get<RelativeFrom>(Trait::relative_from, newer), RelativeFrom::target);
  EXPECT_EQ(traits.get<RelativeAnswer>(Trait::relative_answer, old), RelativeAnswer::distance);
  EXPECT_EQ(traits.get<RelativeAnswer>(Trait::relative_answer, newer), RelativeAnswer::target);
  traits.set(Trait::relative_from, RelativeFrom::actual);
  EXPECT_FALSE(traits.empty());
  EXPECT_EQ(traits.get<RelativeFrom>(Trait::relative_from, newer), RelativeFrom::actual);
}

TEST(Traits, OfTheChipConcernOnlyModulesThatHaveIt) {
  const auto& old = *find_model("TMCM-1110");
  const auto& newer = *find_model("TMCM-1276");
  EXPECT_TRUE(concerns(Trait::last_step, old));
  EXPECT_FALSE(concerns(Trait::last_step, newer));
  EXPECT_TRUE(concerns(Trait::limit_stop, newer));
}

ModuleSettings settings_of(const std::string& text) {
  const auto file = parse_module_file(text, "m.toml", *tmcl::find_model("TMCM-1110"));
  EXPECT_TRUE(file) << file.error();
  return file.value_or(ModuleSettings{});
}
std::string error_of(const std::string& text, std::string_view model = "TMCM-1110") {
  const auto file = parse_module_file(text, "m.toml", *tmcl::find_model(model));
  return file ? "" : file.error();
}
const std::string head = "[module]\nmodel = \"TMCM-1110\"\n";

TEST(ModuleFile, TellsWhatItSaysAndNothingElse) {
  const auto settings = settings_of(head +
                                    "firmware_version = \"1.09\"\nanswer_us = 1840\n"
                                    "last_step = \"r2\"\nheartbeat = \"ignored\"\n"
                                    "behaviour = \"lite\"\ndata_logger = true\n");
  EXPECT_EQ(settings.firmware, (tmcl::sim::FirmwareRelease{1, 9}));
  EXPECT_EQ(settings.to_answer, std::chrono::microseconds(1840));
  EXPECT_EQ(settings.traits.find(Trait::last_step), index_of(tmcl::ramp::Tmc429::LastStep::r2));
  EXPECT_EQ(settings.traits.find(Trait::heartbeat), index_of(tmcl::Heartbeat::ignored));
  EXPECT_FALSE(settings.traits.find(Trait::order));
  EXPECT_EQ(settings.behaviour, tmcl::sim::Behaviour::lite);
  EXPECT_EQ(settings.data_logger, true);
}

TEST(ModuleFile, NamesLineAndNearestKeyOrWord) {
  EXPECT_EQ(error_of("[module]\n"), "m.toml:1: this module has no 'model'");
  EXPECT_EQ(error_of("[module]\nmodel = \"TMCM-1111O\"\n"),
            "m.toml:2: there is no module 'TMCM-1111O'. Did you mean 'TMCM-1111'?");
  EXPECT_EQ(error_of(head + "last_stepp = \"r3\"\n"),
            "m.toml:3: there is no key 'last_stepp'. Did you mean 'last_step'?");
  EXPECT_EQ(error_of(head + "order = \"ramp_frist\"\n"),
            "m.toml:3: 'order' is 'ramp_frist', but must be ramp_first or pulse_first. Did you "
            "mean 'ramp_first'?");
  EXPECT_EQ(error_of(head + "answer_us = -1\n"),
            "m.toml:3: 'answer_us' is -1, but must be 0 to 1000000");
  EXPECT_EQ(error_of("[module]\nmodel = \"TMCM-1276\"\norder = \"pulse_first\"\n", "TMCM-1276"),
            "m.toml:3: a TMCM-1276 has no TMC429: 'order' can only be ramp_first");
  EXPECT_EQ(error_of(head, "TMCM-6212"), "m.toml:2: this is a TMCM-1110, not a TMCM-6212");
  EXPECT_EQ(error_of("module = 1\n"), "m.toml:1: there is no section [module]");
  EXPECT_EQ(error_of(head + "address = 1\n"),
            "m.toml:3: there is no key 'address'. Did you mean 'addressing'?");
  EXPECT_NE(error_of("[module\n"), "");
  EXPECT_NE(error_of("[modul]\n"), "");
}

TEST(ModuleFile, ThatIsNotThereIsAnError) {
  const auto file = read_module_file("/nowhere/m.toml", *tmcl::find_model("TMCM-1110"));
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error(), "/nowhere/m.toml: cannot be read, or is empty");
}

}  // namespace
}  // namespace tmclsim
