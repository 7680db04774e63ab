// A module that is held against its twin through the gateway: who else may do what meanwhile, what
// ends it, what is left then, and what becomes of what was found.
#include <gmock/gmock.h>

#include <fstream>

#include "support/temp_path.hpp"
#include "tmcl/parameter_number.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto settings = std::to_array<std::uint8_t>(
    {ap::max_velocity, ap::max_acceleration, tmcl::number_of("minimum_velocity"),
     tmcl::number_of("ramp_divisor"), tmcl::number_of("pulse_divisor")});

class VerifiedAxis : public Cable {
 protected:
  explicit VerifiedAxis(const std::string& config = cable_config) : Cable(config, "TMCM-3110") {
    for (const auto parameter : settings) before.push_back(get(0, parameter));
  }
  Answer begin_verification() {
    return begin("axis.verify", {{"axis", "x"}, {"from", "-1mm"}, {"to", "1mm"}});
  }
  /// In the midst of its movements.
  Answer verification_under_way() {
    auto answer = begin_verification();
    EXPECT_TRUE(time.run_while_not([&] { return get(0, settings[4]) > 6 && moves(); }, 1min));
    return answer;
  }
  void expect_as_before() {
    EXPECT_FALSE(moves());
    for (std::size_t i = 0; i < settings.size(); ++i)
      EXPECT_EQ(get(0, settings[i]), before[i]) << int{settings[i]};
    EXPECT_THAT(call("lease.list", {})->at("leases").as_array(), IsEmpty());
  }

  std::vector<std::int32_t> before;
};

TEST_F(VerifiedAxis, IsMeasuredAndAsItWas) {
  const auto position = get(0, ap::actual_position);
  const auto result = end(begin_verification());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->at("model"), "TMCM-3110");
  EXPECT_EQ(result->at("firmware"), "1.14");
  int measured = 0;
  for (const auto& trait : result->at("traits").as_array()) {
    if (!trait.at("measured").as_bool()) continue;
    ++measured;
    // Which stage of the chip is first does not show in most movements.
    const auto& fits = trait.at("fits").as_array();
    EXPECT_NE(std::ranges::find(fits, trait.at("foreseen")), fits.end()) << trait;
    EXPECT_TRUE(fits.size() == 1 || trait.at("trait") == "order") << trait;
  }
  EXPECT_EQ(measured, 9);
  EXPECT_EQ(get(0, ap::actual_position), position);
  expect_as_before();
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 1}}));
}

TEST_F(VerifiedAxis, IsMovedAndSetByNobodyElse) {
  const auto answer = verification_under_way();
  be_another_client();
  EXPECT_EQ(name_of_error(call("axis.move_to", {{"axis", "x"}, {"position", 1}})), "axis_claimed");
  EXPECT_EQ(name_of_error(call("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 1}})),
            "leased");
  EXPECT_TRUE(end(answer));
}

TEST_F(VerifiedAxis, StandsAndHasItsSettingsAfterAStop) {
  const auto answer = verification_under_way();
  be_another_client();
  EXPECT_TRUE(call("axis.stop", {{"axis", "x"}}));
  EXPECT_EQ(name_of_error(end(answer)), "superseded_by_stop");
  time.run_for(2s);
  expect_as_before();
}

TEST_F(VerifiedAxis, StandsAndHasItsSettingsWhenWhoeverAskedForItHasGone) {
  verification_under_way();
  client_leaves();
  time.run_for(5s);
  be_another_client();
  expect_as_before();
}

TEST_F(VerifiedAxis, GetsItsSettingsBackWhenTheCableIsThereAgain) {
  const auto answer = verification_under_way();
  wire.is_cut = true;
  EXPECT_FALSE(end(answer));
  wire.is_cut = false;
  time.run_for(30s);
  expect_as_before();
}

TEST_F(VerifiedAxis, IsRefusedToOthersThanItsHolder) {
  ASSERT_TRUE(call("lease.acquire", {{"axes", {"x"}}, {"ttl_ms", 60000}}));
  be_another_client();
  EXPECT_EQ(name_of_error(end(begin_verification())), "leased");
}

TEST_F(VerifiedAxis, IsVerifiedUnderTheLeaseOfWhoeverAsksForIt) {
  ASSERT_TRUE(call("lease.acquire", {{"axes", {"x"}}, {"ttl_ms", 60000}}));
  EXPECT_TRUE(end(begin_verification()));
  EXPECT_EQ(call("lease.list", {})->at("leases").as_array().size(), 1U);
}

TEST_F(VerifiedAxis, NeedsATravelOrSoftLimits) {
  const auto result = call("axis.verify", {{"axis", "x"}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::bad_request);
  EXPECT_THAT(result.error().message, HasSubstr("no soft limits"));
  EXPECT_EQ(name_of_error(call("axis.verify", {{"axis", "x"}, {"from", "1mm"}, {"to", "2mm"}})),
            "out_of_range");
  EXPECT_EQ(name_of_error(call("axis.verify", {{"axis", "x"}, {"from", "-1mm"}})), "bad_argument");
}

// ---- as = "FILE" ------------------------------------------------------------------------------

std::string measured_file(std::string_view model) {
  auto file = tmcl::test::temp_path("measured.toml");
  std::ofstream(file) << "[module]\nmodel = \"" << model << "\"\nlast_step = \"r2\"\n";
  return file;
}

double seconds_foreseen(const std::string& file) {
  std::string more = "[[module]]\nbus = \"bench\"\naddress = 1\nas = \"" + file + "\"\n";
  CableBench bench(cable_config + (file.empty() ? "" : more), "TMCM-3110");
  for (const auto& [parameter, value] :
       {std::pair{4, 1000}, {5, 500}, {130, 1}, {153, 5}, {154, 5}})
    bench.call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
  const auto moved = bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}});
  return moved ? moved->at("predicted_s").as_double() : 0;
}

TEST(MeasuredModule, IsForeseenAsItWasMeasured) {
  EXPECT_NEAR(seconds_foreseen({}), 0.131, 0.005);
  EXPECT_LT(seconds_foreseen(measured_file("TMCM-3110")), 0.06);
}

TEST(MeasuredModule, IsForeseenAsUsualIfItIsOfAnotherModel) {
  EXPECT_NEAR(seconds_foreseen(measured_file("TMCM-1110")), 0.131, 0.005);
}

TEST(MeasuredModule, IsAnErrorOfTheConfigurationIfItsFileIsWrong) {
  const auto file = tmcl::test::temp_path("wrong.toml");
  std::ofstream(file) << "[module]\nmodel = \"TMCM-3110\"\nlast_stop = \"r2\"\n";
  const auto config =
      parse_config(std::string(cable_config) + "[[module]]\nbus = \"bench\"\naddress = 1\nas = \"" +
                   file + "\"\n");
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().front().message,
              HasSubstr(":3: there is no key 'last_stop'. Did you mean 'last_step'?"));
}

}  // namespace
}  // namespace tmcld::test
