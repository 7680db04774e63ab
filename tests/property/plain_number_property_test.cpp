// Numbers for people: without an exponent, and as exact as was asked for.
#include "tmcl/plain_number.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmcl {
namespace {

double read(const std::string& text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value).ptr;
  EXPECT_EQ(end, text.data() + text.size()) << text;
  return value;
}

/// Half of the last of so many digits.
double rounding(double value, int digits) {
  const double place = std::pow(10, std::floor(std::log10(std::abs(value))) + 1 - digits);
  const bool is_whole = std::abs(value) < 1e15 && place > 1;
  return (is_whole ? 1 : place) * 0.5000001 + std::abs(value) * 1e-15;
}

void check(double value, int digits) {
  const auto text = plain_number(value, digits);
  SCOPED_TRACE(testing::Message() << text << " for " << value << " in " << digits << " digits");
  ASSERT_LE(std::abs(read(text) - value), rounding(value, digits));
  const bool plain = std::abs(value) >= 1e-6 && std::abs(value) < 1e15;
  if (!plain) return;
  ASSERT_EQ(text.find('e'), std::string::npos);
  if (text.find('.') == std::string::npos) return;
  ASSERT_NE(text.back(), '0');
  ASSERT_NE(text.back(), '.');
  ASSERT_LE(text.size() - (value < 0), 2U + 6U + static_cast<std::size_t>(digits));
}

TEST(PlainNumber, HasNoExponentAndAsManyDigitsAsAreAskedFor) {
  EXPECT_EQ(plain_number(6e5, 6), "600000");
  EXPECT_EQ(plain_number(600000.25, 6), "600000");
  EXPECT_EQ(plain_number(1862645149.23, 6), "1862645149");
  EXPECT_EQ(plain_number(999999.7, 6), "1000000");
  EXPECT_EQ(plain_number(12.5, 6), "12.5");
  EXPECT_EQ(plain_number(-0.0001, 4), "-0.0001");
  EXPECT_EQ(plain_number(2.0 / 3, 3), "0.667");
  EXPECT_EQ(plain_number(-0.0, 6), "0");
  EXPECT_EQ(plain_number(100, 1), "100");
  EXPECT_EQ(plain_number(1e15, 6), "1e+15");
  EXPECT_EQ(plain_number(1e6), "1000000");
  EXPECT_EQ(plain_number(0.1), "0.1");
  EXPECT_EQ(plain_number(std::numeric_limits<double>::infinity(), 6), "inf");
}

TEST(PlainNumber, IsTheNumberRounded) {
  test::Random<> random(test::seed());
  for (int i = 0; i < 100'000; ++i) {
    const auto digits = static_cast<int>(random.between(1, 17));
    const auto half = [&] { return static_cast<std::uint64_t>(random.between(0, UINT32_MAX)); };
    const auto bits = half() << 32U | half();
    const auto any = std::bit_cast<double>(bits);
    if (std::isnormal(any) && std::abs(any) < 1e300) check(any, digits);
    check(static_cast<double>(random.between(1, 1'000'000'000)) *
              std::pow(10, random.between(-12, 9)),
          digits);
    if (testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace tmcl
