// axis.get_errors: what a module knows about itself, in words.
#include <gmock/gmock.h>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint8_t home_switch = 9;
constexpr std::uint8_t right_limit_switch = 10;
constexpr std::uint8_t left_limit_switch = 11;
constexpr std::uint8_t extended_error_flags = 207;
constexpr std::uint8_t driver_status_flags = 208;

class Errors : public testing::Test {
 protected:
  Errors() {
    for (const auto parameter : {extended_error_flags, driver_status_flags, left_limit_switch,
                                 right_limit_switch, home_switch})
      set(parameter, 0);
    module().refuse = [this](const tmcl::Request& request) -> std::optional<tmcl::Status> {
      const bool refused = request.command == tmcl::Command::GIO && measures_nothing_;
      return refused ? std::optional(tmcl::Status::wrong_type) : std::nullopt;
    };
  }

  tmcl::test::FakeModule& module() { return gateway.wire.modules.at(1); }
  void set(std::uint8_t parameter, std::int32_t value) { module().parameter(0, parameter) = value; }
  json::object errors() { return gateway.call("axis.get_errors", {{"axis", "x"}}).value(); }
  std::vector<std::string> names(const char* member) {
    std::vector<std::string> all;
    const auto told = errors();
    for (const auto& name : told.at(member).as_array()) all.emplace_back(name.as_string());
    return all;
  }

  VirtualGateway gateway;
  bool measures_nothing_ = false;
};

TEST_F(Errors, AreNamed) {
  set(tmcl::axis_parameter::actual_velocity, 0);
  EXPECT_THAT(names("flags"), IsEmpty());
  set(driver_status_flags, 255);
  EXPECT_THAT(names("flags"), ElementsAre("overtemperature", "overtemperature_warning",
                                          "short_to_ground_a", "short_to_ground_b"));
  EXPECT_THAT(names("unproven"), ElementsAre("open_load_a", "open_load_b"));
  // Load and standstill are no faults.
  set(driver_status_flags, 1 | 128);
  EXPECT_THAT(names("flags"), IsEmpty());
}

TEST_F(Errors, ThatReadingClearsAreKeptAsTheCauseOfTheStop) {
  for (const auto& [bit, name] : {std::pair(1, "stall"), std::pair(2, "deviation")}) {
    set(extended_error_flags, bit);
    EXPECT_THAT(names("flags"), ElementsAre(name));
    set(extended_error_flags, 0);
    EXPECT_THAT(names("flags"), IsEmpty());
    EXPECT_EQ(errors().at("stop_cause"), name);
  }
}

TEST_F(Errors, SayWhichSwitchesAreClosed) {
  set(left_limit_switch, 1);
  set(home_switch, 1);
  EXPECT_THAT(names("switches"), ElementsAre("left", "home"));
}

TEST_F(Errors, HaveSupplyAndTemperatureWhereTheModuleMeasuresThem) {
  measures_nothing_ = true;
  EXPECT_TRUE(errors().at("supply_volts").is_null());
  EXPECT_TRUE(errors().at("temperature_celsius").is_null());
}

}  // namespace
}  // namespace tmcld::test
