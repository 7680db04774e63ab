// Methods of tmcld in the words of the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "api/method.hpp"
#include "command_line/method_words.hpp"
#include "command_line/options.hpp"
#include "output/errors.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string help_of(std::string verb) {
  std::istringstream in(verb + " --help");
  const std::vector<std::string> words{std::istream_iterator<std::string>(in), {}};
  return std::get<Information>(parse_options(words).value()).text;
}

TEST(CtlMethodWords, EveryMethodHasAVerbThatIsThere) {
  for (const auto& method : tmcld::method_table()) {
    if (method.name.find('.') == std::string_view::npos) continue;
    EXPECT_EQ(std::ranges::count(method_words(), method.name, &MethodWord::method), 1)
        << method.name;
  }
  for (const auto& word : method_words()) {
    EXPECT_NE(tmcld::find_method(word.method), nullptr) << word.method;
    const std::string text(word.verb);
    const auto option = std::min(text.find("--"), text.size());
    const auto help = help_of(text.substr(0, option));
    EXPECT_THAT(help, HasSubstr(text.substr(0, option))) << "unknown verb";
    EXPECT_THAT(help, HasSubstr(text.substr(option)));
  }
}

TEST(CtlMethodWords, NothingThatTmcldSaysIsShownWithAMethod) {
  for (const auto& method : tmcld::method_table()) {
    if (method.name.find('.') == std::string_view::npos) continue;
    const std::string name(method.name);
    const auto failure =
        usage_error("some_error", name + " cannot do that", "see " + name + " for it");
    EXPECT_THAT(error_text(failure), Not(HasSubstr(name)));
    const auto json = error_document(failure);
    EXPECT_THAT(std::string(json.at("message").as_string()), Not(HasSubstr(name)));
    EXPECT_THAT(std::string(json.at("hint").as_string()), Not(HasSubstr(name)));
  }
}

TEST(CtlMethodWords, AWholeNameBecomesAVerb) {
  EXPECT_EQ(with_verbs("see axis.list for what there is"), "see 'tmclctl axes' for what there is");
  EXPECT_EQ(with_verbs("hand it over with path.stage."), "hand it over with 'tmclctl path run'.");
  EXPECT_EQ(with_verbs("axis.stop_home, axis.stop"), "'tmclctl home --stop', 'tmclctl stop'");
}

TEST(CtlMethodWords, ACommandThatIsProposedReachesTheSameGateway) {
  constexpr auto here = " --direct can:can0";
  EXPECT_EQ(with_gateway("try 'tmclctl axes', or 'tmclctl path run'", here),
            "try 'tmclctl --direct can:can0 axes', or 'tmclctl --direct can:can0 path run'");
  EXPECT_EQ(with_gateway("'tmclctl state x'", ""), "'tmclctl state x'");
  for (const auto* text : {"'tmclctl path check' reads it", "'tmclctl models'", "'tmclctl --help'",
                           "'tmclctl axess'", "tmclctl axes", "'tmclctl ", ""}) {
    EXPECT_EQ(with_gateway(text, here), text);
  }
}

TEST(CtlMethodWords, OtherWordsStayAsTheyAre) {
  for (const auto* text : {"cannot read /tmp/path.run", "path.run.csv", "no axis my_axis.list",
                           "axis.lists", "the axis. list them", ""}) {
    EXPECT_EQ(with_verbs(text), text);
  }
}

}  // namespace
}  // namespace tmclctl
