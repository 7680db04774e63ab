// "Did you mean ...?" of the gateway.
#include <gtest/gtest.h>

#include <array>

#include "api/suggest.hpp"

namespace tmcld {
namespace {

using namespace std::string_view_literals;

constexpr std::array names{"max_velocity"sv,   "target_velocity"sv, "max_current"sv,
                           "serial_address"sv, "host_address"sv,    "Standby_Current"sv,
                           "a_velocity_b"sv,   "ramp_mode"sv};

std::string suggested(std::string_view word) { return suggest(word, names, "look"); }

TEST(Suggest, NamesThatHaveTheWord) {
  EXPECT_EQ(suggested("address"), "Did you mean 'serial_address' or 'host_address'?");
  EXPECT_EQ(suggested("velocity"),
            "Did you mean 'max_velocity', 'target_velocity' or 'a_velocity_b'?");
  EXPECT_EQ(suggested("CURRENT"), "Did you mean 'max_current' or 'Standby_Current'?");
  EXPECT_EQ(suggested("mode"), "Did you mean 'ramp_mode'?");
}

TEST(Suggest, TheNameThatIsNear) {
  EXPECT_EQ(suggested("rampmode"), "Did you mean 'ramp_mode'?");
  EXPECT_EQ(suggested("ser"), "Did you mean 'serial_address'?");
}

TEST(Suggest, NothingWhereNoNameIsNear) {
  EXPECT_EQ(suggested("elocity"), "look") << "no whole part of a name";
  EXPECT_EQ(suggested(""), "look");
  EXPECT_EQ(suggested("speed"), "look");
  std::array<std::string_view, 9> many{"a_x", "b_x", "c_x", "d_x", "e_x",
                                       "f_x", "g_x", "h_x", "i_x"};
  EXPECT_EQ(suggest("x", many, "look"), "look") << "too many to choose from";
}

}  // namespace
}  // namespace tmcld
