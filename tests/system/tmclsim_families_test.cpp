// The command line with simulated modules of every family.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/program.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class TmclsimFamilies : public testing::Test {
 protected:
  TmclsimFamilies() {
    folder_ = std::filesystem::temp_directory_path() / "tmclsim-XXXXXX";
    if (::mkdtemp(folder_.data()) == nullptr) throw std::runtime_error("no folder to be had");
    simulator_ =
        std::make_unique<Program>(Words{"tmclsim", "--module", "TMCM-1110", "--module", "pd-146",
                                        "--module", "6212", "--pty", folder_ + "/bus"});
    EXPECT_TRUE(simulator_->wait_for("ready")) << simulator_->output();
  }
  ~TmclsimFamilies() override {
    simulator_.reset();
    std::filesystem::remove_all(folder_);
  }

  using Words = std::vector<std::string>;
  Finished ctl(const Words& words) const {
    Words all{"tmclctl", "--direct", "serial:" + folder_ + "/bus@115200"};
    all.insert(all.end(), words.begin(), words.end());
    return run_program(all);
  }
  std::string said(const Words& words) const { return ctl(words).output; }

  std::string folder_;
  std::unique_ptr<Program> simulator_;
};

TEST_F(TmclsimFamilies, AreAnnouncedAndFound) {
  EXPECT_THAT(simulator_->output(), HasSubstr("module 2 PD-146, 1 motor, "));
  EXPECT_THAT(simulator_->output(), HasSubstr("module 3 TMCM-6212, 6 motors, "));
  const auto found = said({"scan", "--addresses", "1-3"});
  for (const auto* name : {"TMCM-1110", "PD-146", "TMCM-6212"}) {
    EXPECT_THAT(found, HasSubstr(name));
  }
}

TEST_F(TmclsimFamilies, HaveTheirOwnParameters) {
  EXPECT_THAT(said({"params", "1/0"}), HasSubstr("pulse_divisor"));
  EXPECT_THAT(said({"params", "2/0"}), HasSubstr("max_bow"));
  EXPECT_THAT(said({"params", "3/5"}), HasSubstr("velocity_v1"));
  EXPECT_THAT(said({"params", "3/5"}), Not(HasSubstr("max_bow")));
}

TEST_F(TmclsimFamilies, ResolveNamesByTheModel) {
  EXPECT_EQ(ctl({"set", "2/0", "a_max", "5000"}).status, 0);
  EXPECT_EQ(said({"get", "2/0", "16"}), "5000\n");
  EXPECT_EQ(said({"get", "2/0", "ramp_mode"}), "0\n");  // 128 here, 138 on the other
  EXPECT_EQ(said({"get", "1/0", "ramp_mode"}), "0\n");
  EXPECT_EQ(said({"get", "3/0", "v1"}), "25600\n");
  EXPECT_THAT(said({"get", "3/0", "ramp_mode"}), HasSubstr("no parameter 'ramp_mode'"));
  EXPECT_THAT(said({"--json", "get", "2/0", "130"}), HasSubstr("velocity_reached"));
  EXPECT_THAT(said({"--json", "get", "1/0", "130"}), HasSubstr("minimum_velocity"));
}

TEST_F(TmclsimFamilies, TakeNoNameForGrantedWhereTheModelIsNotAskedFor) {
  EXPECT_THAT(said({"raw", "3", "GAP", "ramp_mode", "0", "0"}),
              HasSubstr("no parameter 'ramp_mode'"));
  EXPECT_THAT(said({"raw", "3", "GAP", "max_velocity", "0", "0"}), HasSubstr("value 51200"));
  EXPECT_THAT(said({"raw", "1", "GAP", "pulse_divisor", "0", "0"}),
              HasSubstr("no parameter 'pulse_divisor'"));
}

TEST_F(TmclsimFamilies, Move) {
  EXPECT_EQ(said({"move", "2/0", "20000", "--wait"}), "2/0 stands at 20000\n");
  EXPECT_EQ(said({"move", "3/5", "-10000", "--wait"}), "3/5 stands at -10000\n");
  EXPECT_EQ(ctl({"move", "3/5", "2000000000"}).status, 0);
  EXPECT_EQ(ctl({"move", "1/0", "2000000000"}).status, 2) << "24 bit";
}

}  // namespace
}  // namespace tmcl::test
