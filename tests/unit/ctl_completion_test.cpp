// What a shell offers at the cursor.
#include <gmock/gmock.h>

#include "command_line/options.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmclctl::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Without a gateway.
std::string offered(std::vector<std::string> typed) {
  typed.insert(typed.begin(), {"__complete", "line", "--"});
  const auto parsed = parse_options(typed);
  const auto* information = parsed ? std::get_if<Information>(&*parsed) : nullptr;
  return information == nullptr ? "(of the gateway)" : information->text;
}

TEST(CtlCompletion, OffersVerbs) {
  EXPECT_THAT(offered({"mo"}), AllOf(HasSubstr("modules\n"), HasSubstr("models\n")));
  EXPECT_THAT(offered({""}), Not(HasSubstr("__complete")));
  EXPECT_EQ(offered({"profile", ""}), "simulate\nsolve\n");
  EXPECT_THAT(offered({"help", "program", ""}), HasSubstr("verify\n"));
  EXPECT_THAT(offered({"--json", "--socket", "/tmp/s", "settings", ""}), HasSubstr("save\n"));
}

TEST(CtlCompletion, OffersOptionsOfTheProgramAndOfTheVerb) {
  EXPECT_THAT(offered({"plot", "x", "--"}), HasSubstr("--svg\n"));
  EXPECT_THAT(offered({"plot", "x", "--"}), HasSubstr("--json\n"));
  EXPECT_THAT(offered({"--"}), Not(HasSubstr("--svg\n")));
}

TEST(CtlCompletion, AsksTheGatewayForWhatOnlyItKnows) {
  for (const std::vector<std::string>& typed : {std::vector<std::string>{"move", ""},
                                                {"wait", "x", ""},
                                                {"line", "x=3", ""},
                                                {"path", "pause", ""},
                                                {"home", "x", ""},
                                                {"settings", "show", ""},
                                                {"settings", "save", "--bus", ""},
                                                {"trace", ""},
                                                {"global", "get", ""},
                                                {"path", "run", "a.ngc", "--axis", "X="},
                                                {"doctor", ""}})
    EXPECT_EQ(offered(typed), "(of the gateway)") << typed.back();
}

TEST(CtlCompletion, OffersNothingForNumbersAndWhatCannotBeKnown) {
  for (const std::vector<std::string>& typed : {std::vector<std::string>{"move", "x", ""},
                                                {"line", "x="},
                                                {"watch", "x", "--for", ""},
                                                {"set", "x", "max_velocity", ""},
                                                {"profile", "solve", "distance="}})
    EXPECT_EQ(offered(typed), "") << typed.back();
}

TEST(CtlCompletion, OffersFiles) {
  for (const std::vector<std::string>& typed : {std::vector<std::string>{"path", "check", ""},
                                                {"--config", ""},
                                                {"plot", "x", "--svg", ""},
                                                {"settings", "load", ""},
                                                {"settings", "diff", "a.toml", ""}})
    EXPECT_EQ(offered(typed), ":files\n") << typed.front();
}

TEST(CtlCompletion, OffersParametersCommandsAndModels) {
  EXPECT_THAT(offered({"get", "x", ""}), HasSubstr("max_velocity\n"));
  EXPECT_THAT(offered({"global", "get", "1", ""}), HasSubstr("can_id\n"));
  EXPECT_THAT(offered({"global", "get", "1", ""}), Not(HasSubstr("max_velocity\n")));
  EXPECT_THAT(offered({"raw", "1", ""}), HasSubstr("GAP\n"));
  EXPECT_THAT(offered({"params", "--model", ""}), HasSubstr("TMCM-1110\n"));
  EXPECT_EQ(offered({"token", "add", "anna", "--role", ""}), "observe\noperate\nconfigure\n");
  EXPECT_EQ(offered({"path", "run", "--mode", ""}), "velocity\nsegments\nposition\n");
}

TEST(CtlCompletion, OffersRegistersAndTheirValues) {
  EXPECT_THAT(offered({"profile", "simulate", "--generator", "tmc429", ""}), HasSubstr("v_max=\n"));
  EXPECT_THAT(offered({"profile", "simulate", "--generator", "tmc429", "mode="}),
              StartsWith("mode="));
  EXPECT_THAT(offered({"profile", "simulate", "--model", "TMCM-142", ""}), HasSubstr("max_bow=\n"));
  EXPECT_THAT(offered({"profile", "solve", ""}), HasSubstr("distance=\n"));
}

/// Whatever is typed, nothing breaks.
TEST(CtlCompletion, TakesAnyWords) {
  const std::vector<std::string> words{"move", "--by", "=",       ":",        "-",
                                       "--",   "",     "path",    "run",      "--axis",
                                       "X=x",  "\xff", "profile", "simulate", "help"};
  const auto seed = tmcl::test::seed();
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
  tmcl::test::Random<std::size_t> random(seed);
  for (const auto& first : words)
    for (const auto& second : words)
      offered({first, second, words[random.between(0, words.size() - 1)]});
}

}  // namespace
}  // namespace tmclctl::test
