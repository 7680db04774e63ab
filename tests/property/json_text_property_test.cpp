// Numbers in JSON: as people write them, and read as the same again.
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <boost/json/array.hpp>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/json_text.hpp"

namespace tmcl {
namespace {

namespace json = boost::json;

double read(const std::string& text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value).ptr;
  EXPECT_EQ(end, text.data() + text.size()) << text;
  return value;
}

void check(double number) {
  const auto text = json_text(json::value(number));
  ASSERT_EQ(read(text), number) << text;
  ASSERT_LE(text.size(), 25U) << text;
  ASSERT_EQ(text.find('E'), std::string::npos) << text;
  const double size = std::abs(number);
  const bool plain = number == 0 || (size >= 1e-6 && size < 1e15);
  ASSERT_EQ(text.find('e') == std::string::npos, plain) << text;
}

TEST(JsonText, NumbersAreWrittenAsPeopleWriteThem) {
  const json::array numbers{
      10240.0, 0.5,     0.0, -0.0,      1e5,  100000.0, 0.0001, -12.25,
      1e-5,    30517.6, 8.0, 1.0 / 3.0, 1e15, 1e-7,     -3,     18446744073709551615U};
  EXPECT_EQ(json_text(numbers),
            "[10240,0.5,0,0,100000,100000,0.0001,-12.25,0.00001,30517.6,8,0.3333333333333333,"
            "1e+15,1e-07,-3,18446744073709551615]");
  EXPECT_EQ(json_text(json::object{{"nan", std::nan("")}}), R"({"nan":null})");
}

TEST(JsonText, EveryNumberIsReadAsItself) {
  test::Random<> random(test::seed());
  for (int i = 0; i < 200'000; ++i) {
    const auto bits = static_cast<std::uint64_t>(random.between(INT64_MIN, INT64_MAX));
    const auto any = std::bit_cast<double>(bits);
    if (std::isfinite(any)) check(any);
    check(static_cast<double>(random.between(-1'000'000'000, 1'000'000'000)) /
          std::pow(10, random.between(0, 9)));
    if (HasFatalFailure()) return;
  }
  for (const double edge :
       {1e-6, std::nextafter(1e-6, 0), 1e15, std::nextafter(1e15, 0),
        std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max()})
    check(edge);
}

}  // namespace
}  // namespace tmcl
