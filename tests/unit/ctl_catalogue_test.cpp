// models, params --model: the tables on the screen, without any module.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;
using testing::Not;

class CtlCatalogue : public testing::Test, public test::CtlBench {};

TEST_F(CtlCatalogue, ListsEveryModel) {
  EXPECT_EQ(run({"models"}), ExitCode::done);
  for (const auto& model : tmcl::models()) EXPECT_THAT(out, HasSubstr(std::string(model.name)));
}

TEST_F(CtlCatalogue, ListsModelsAsJson) {
  EXPECT_EQ(run({"--json", "models"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr(R"("number":6214,"name":"TMCM-6214","axes":6,"ramps":"sixPoint")"));
  EXPECT_THAT(out, HasSubstr(R"("document":"manual of the TMCM-351, V4.45, Rev. 1.06")"));
}

TEST_F(CtlCatalogue, ListsTheParametersOfAModelWithoutAModule) {
  EXPECT_EQ(run({"params", "--model", "tmcm1276"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("automatic_right_stop"));
  EXPECT_THAT(out, Not(HasSubstr("pulse_divisor")));
}

TEST_F(CtlCatalogue, ListsGlobalParametersToo) {
  EXPECT_EQ(run({"params", "--model", "1110", "--globals"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("serial_baud_rate"));
  EXPECT_THAT(out, Not(HasSubstr("max_velocity")));
}

TEST_F(CtlCatalogue, ListsParametersAsJson) {
  EXPECT_EQ(run({"--json", "params", "--model", "TMCM-142"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr(R"({"model":"TMCM-142","parameters":[{"number":0)"));
  EXPECT_THAT(out, HasSubstr(R"("register":"BOW_MAX")"));
}

TEST_F(CtlCatalogue, SuggestsTheModelThatWasMeant) {
  EXPECT_EQ(run({"params", "--model", "TMCM-1275"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("there is no model 'TMCM-1275'"));
  EXPECT_THAT(err, HasSubstr("tmclctl models"));
}

TEST_F(CtlCatalogue, WantsEitherAnAxisOrAModel) {
  EXPECT_EQ(run({"params"}), ExitCode::usage);
  EXPECT_EQ(run({"params", "x", "--model", "TMCM-1110"}), ExitCode::usage);
  EXPECT_EQ(run({"params", "x", "--globals"}), ExitCode::usage);
  EXPECT_EQ(run({"params", "--model", "TMCM-1110", "--values"}), ExitCode::usage);
}

}  // namespace
}  // namespace tmclctl
