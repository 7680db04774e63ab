// Numbers with units, and what they are to an axis.
#include "tmcl/quantity.hpp"

#include <gmock/gmock.h>

namespace tmcl::test {
namespace {

using testing::HasSubstr;

Quantity parsed(std::string_view text) {
  const auto quantity = parse_quantity(text);
  EXPECT_TRUE(quantity) << text << ": " << quantity.error().message;
  return quantity.value_or(Quantity{});
}

Error error_in(std::string_view text) {
  const auto quantity = parse_quantity(text);
  EXPECT_FALSE(quantity) << text;
  return quantity ? Error{} : quantity.error();
}

TEST(ParseQuantity, TakesANumberAndPerhapsAUnit) {
  EXPECT_EQ(parsed("12.5mm"), (Quantity{12.5, "mm"}));
  EXPECT_EQ(parsed("-300 rpm"), (Quantity{-300, "rpm"}));
  EXPECT_EQ(parsed("+2.5e2  pps/s"), (Quantity{250, "pps/s"}));
  EXPECT_EQ(parsed("12in"), (Quantity{12, "in"}));
  EXPECT_EQ(parsed("5e"), (Quantity{5, "e"}));
  EXPECT_EQ(parsed("010"), (Quantity{10, ""}));
  EXPECT_EQ(parsed("7 "), (Quantity{7, ""}));
  EXPECT_EQ(parsed("50mm/s^2"), (Quantity{50, "mm/s^2"}));
}

TEST(ParseQuantity, EachFaultHasAnErrorOfItsOwn) {
  for (const auto* text : {"", "mm", "ten", "--5mm", "+-5", "1/s", " 5mm"})
    EXPECT_EQ(error_in(text).code, Errc::bad_quantity) << text;
  EXPECT_EQ(error_in("12,5mm").code, Errc::decimal_comma);
  EXPECT_THAT(error_in("-12,5 mm").hint, HasSubstr("-12.5 mm"));
  for (const auto* text : {"nan", "inf", "-infinity", "nanmm", "1e999mm"})
    EXPECT_EQ(error_in(text).code, Errc::not_finite) << text;
  for (const auto* text : {"12mm 5um", "12mm5", "1 mm rev", "3m2", "1.2.3mm", "12, 5mm"})
    EXPECT_EQ(error_in(text).code, Errc::two_units) << text;
}

class AxisQuantity : public testing::Test {
 protected:
  std::int32_t microsteps(std::string_view text) {
    const auto value = to_microsteps(parsed(text), x);
    EXPECT_TRUE(value) << value.error().message;
    return value ? value->value : 0;
  }
  Result<std::int32_t> in(std::uint8_t parameter, std::string_view text) {
    return to_parameter(parsed(text), x, *find_parameter(x.parameters(), parameter));
  }
  Error refused(std::uint8_t parameter, std::string_view text) {
    const auto value = in(parameter, text);
    EXPECT_FALSE(value) << text;
    return value ? Error{} : value.error();
  }

  AxisUnits x{"x", find_model("TMCM-1110"), module_units(Tmc429Dividers{2, 3}),
              UserScale{"mm", 5, false, {200, 8}}};
};

TEST_F(AxisQuantity, LengthsConvertIntoEachOther) {
  EXPECT_EQ(microsteps("10mm"), 102'400);
  EXPECT_EQ(microsteps("10000um"), 102'400);
  EXPECT_EQ(microsteps("1 cm"), 102'400);
  EXPECT_EQ(microsteps("0.01m"), 102'400);
  EXPECT_EQ(microsteps("1in"), 260'096);
  EXPECT_EQ(in_own_unit(parsed("100um"), x), 0.1);
  EXPECT_EQ(in_own_unit(parsed("1in"), x), 25.4);
  EXPECT_EQ(in_own_unit(parsed("1rev"), x), std::nullopt);
  EXPECT_EQ(in(2, "0.5cm/s"), 839);
  EXPECT_EQ(in(5, "5 cm/s^2"), 34);
}

TEST_F(AxisQuantity, AnglesConvertIntoEachOther) {
  x.scale = UserScale{"deg", 360, true, {200, 8}};
  EXPECT_EQ(microsteps("180deg"), -25'600);
  EXPECT_EQ(microsteps("3.141592653589793rad"), -25'600);
  EXPECT_EQ(refused(0, "1mm").code, Errc::unknown_unit);
  x.scale->unit = "rad";
  x.scale->units_per_revolution = 2 * 3.141592653589793;
  EXPECT_EQ(microsteps("180deg"), -25'600);
}

TEST_F(AxisQuantity, AnyOtherUnitConvertsOnlyIntoItself) {
  x.scale->unit = "slides";
  EXPECT_EQ(microsteps("10slides"), 102'400);
  EXPECT_EQ(refused(0, "1mm").code, Errc::unknown_unit);
}

TEST_F(AxisQuantity, EveryAxisHasMicrostepsAndTurns) {
  for (auto* unit : {"mm", ""}) {
    x.scale->unit = unit;
    EXPECT_EQ(microsteps("7microsteps"), 7);
    EXPECT_EQ(microsteps("1microstep"), 1);
    EXPECT_EQ(microsteps("-1.5rev"), -76'800);
    EXPECT_EQ(in(2, "61035pps"), 1000);
    for (const auto* text : {"1rps", "60rpm", "1rev/s"}) EXPECT_EQ(in(2, text), 839) << text;
    for (const auto* text : {"10rps/s", "10rev/s^2", "10rev/s/s", "10rev/s2", "600rpm/s"})
      EXPECT_EQ(in(5, text), 34) << text;
  }
  for (const auto name : reserved_unit_names()) {
    EXPECT_FALSE(fault_of_unit_name(name).empty()) << name;
    const Quantity one{1, std::string(name)};
    EXPECT_TRUE(to_microsteps(one, x) || to_pps(one, x)) << name;
  }
}

TEST_F(AxisQuantity, AReversedAxisTurnsTheOtherWayInEveryUnitButMicrosteps) {
  x.scale->reverse = true;
  EXPECT_EQ(microsteps("10mm"), -102'400);
  EXPECT_EQ(microsteps("1rev"), -51'200);
  EXPECT_EQ(in(2, "1rps"), -839);
  EXPECT_EQ(in(2, "51200pps"), 839);
  EXPECT_EQ(in(4, "5mm/s"), 839) << "a limit has no direction";
  EXPECT_EQ(to_pps(parsed("5mm/s"), x)->value, -51'200);
  EXPECT_EQ(to_pps(parsed("5mm/s"), x.undirected())->value, 51'200);
}

TEST_F(AxisQuantity, ANumberWithoutAUnitIsRefusedWhereTheAxisHasOne) {
  const auto position = refused(0, "12");
  EXPECT_EQ(position.code, Errc::bare_number);
  EXPECT_EQ(position.hint, "12mm or 12microsteps");
  EXPECT_EQ(refused(2, "-1.5").hint, "-1.5mm/s or -1.5pps");
  EXPECT_EQ(refused(5, "1e6").hint, "1000000mm/s^2 or 1000000pps/s");
  EXPECT_EQ(in(0, "0"), 0) << "the same in every unit";
  EXPECT_EQ(in(6, "12"), 12) << "a current has none";
  EXPECT_EQ(to_pps(parsed("5"), x).error().code, Errc::bare_number);
  x.scale->unit.clear();
  EXPECT_EQ(in(0, "12"), 12);
  EXPECT_EQ(in(2, "-12"), -12);
  EXPECT_EQ(to_pps(parsed("1000"), x)->value, 61'035.15625);
  EXPECT_EQ(refused(0, "1.5").code, Errc::bad_quantity);
  EXPECT_EQ(refused(0, "2147483648").code, Errc::out_of_range);
}

TEST_F(AxisQuantity, AUnitThatMeasuresSomethingElseIsRefused) {
  const auto no_velocity = refused(2, "10mm");
  EXPECT_EQ(no_velocity.code, Errc::wrong_unit);
  EXPECT_THAT(no_velocity.message, HasSubstr("'10mm' is no velocity"));
  EXPECT_THAT(no_velocity.hint, HasSubstr("mm/s"));
  EXPECT_THAT(refused(0, "10pps").message, HasSubstr("'10pps' is no position"));
  EXPECT_THAT(refused(5, "10rps").message, HasSubstr("no acceleration"));
  EXPECT_THAT(refused(6, "10rps").message, HasSubstr("max_current is neither"));
}

TEST_F(AxisQuantity, AnUnknownUnitIsToldTheNearest) {
  EXPECT_EQ(refused(0, "12a").code, Errc::unknown_unit);
  EXPECT_THAT(refused(0, "12a").message, HasSubstr("axis x has no unit 'a'"));
  EXPECT_THAT(refused(0, "1revs").hint, HasSubstr("Did you mean 'rev'?"));
  EXPECT_THAT(refused(0, "1mmm").hint, HasSubstr("Did you mean 'mm'?"));
  EXPECT_THAT(refused(2, "3mm/h").hint, HasSubstr("/s behind them"));
  x.scale->unit.clear();
  EXPECT_THAT(refused(0, "1mm").hint, HasSubstr("units_per_revolution"));
}

TEST_F(AxisQuantity, WhatIsNotKnownOfTheModuleIsSaid) {
  x.scale.reset();
  EXPECT_THAT(refused(0, "1rev").message, HasSubstr("how many microsteps a turn of axis x has"));
  EXPECT_EQ(in(0, "7microsteps"), 7);
  x.module.reset();
  EXPECT_THAT(refused(2, "100pps").message, HasSubstr("counts in is not known"));
  EXPECT_THAT(to_pps(parsed("100"), x).error().message, HasSubstr("counts in is not known"));
}

TEST_F(AxisQuantity, WhatDoesNotFitIsRefusedWithTheNearestInTheUnitThatWasSaid) {
  EXPECT_EQ(refused(0, "1000mm").code, Errc::out_of_range);
  EXPECT_THAT(refused(0, "1000mm").message, HasSubstr("1000 mm is too far"));
  EXPECT_THAT(refused(0, "100cm").message, HasSubstr("value is 81.9199"));
  EXPECT_THAT(refused(2, "1e6pps").message, HasSubstr("1000000 pps is too fast"));
  EXPECT_THAT(refused(2, "1e6pps").message, HasSubstr("124938.9 pps"));
  EXPECT_THAT(refused(2, "-600rpm").message, HasSubstr("nearest possible value is -146.4"));
  EXPECT_THAT(refused(5, "1e12pps/s").message, HasSubstr("too large"));
  EXPECT_EQ(in(2, "124938.96484375pps"), 2047) << "the nearest that is named";
}

TEST_F(AxisQuantity, WhatDoesNotFitHasTheMicrostepsThatWouldDo) {
  // 2047 are 124938.96 pps or 12.2 mm/s here.
  EXPECT_THAT(refused(2, "24mm/s").hint,
              HasSubstr("128 microsteps a full step (parameter 140 set to 7)"));
  EXPECT_THAT(refused(2, "-25mm/s").hint, HasSubstr("(parameter 140 set to 6)"));
  EXPECT_THAT(refused(2, "600rpm").hint, HasSubstr("(parameter 140 set to 5)"));
  EXPECT_THAT(refused(0, "1000mm").hint, HasSubstr("(parameter 140 set to 7)"));
  EXPECT_EQ(refused(2, "1e6pps").hint, "");
  EXPECT_EQ(refused(2, "1e6mm/s").hint, "");
}

TEST_F(AxisQuantity, ParametersAreToldInTheUnitOfTheAxisOrInTurns) {
  const auto told = [&](std::uint8_t parameter, std::int32_t value) {
    const auto quantity = from_parameter(value, x, *find_parameter(x.parameters(), parameter));
    return quantity ? to_string(*quantity) : std::string(name_of(quantity.error().code));
  };
  x.scale->reverse = true;
  EXPECT_EQ(told(1, 25'600), "-2.5mm");
  EXPECT_EQ(told(4, 839), "5.000829696655273mm/s") << "a limit has no direction";
  EXPECT_THAT(told(5, 100), testing::EndsWith("mm/s^2"));
  EXPECT_EQ(told(6, 5), "wrong_unit");
  x.scale->unit.clear();
  EXPECT_EQ(told(1, 25'600), "-0.5rev");
  x.module.reset();
  EXPECT_EQ(told(4, 839), "unknown_unit");
  x.scale.reset();
  EXPECT_EQ(told(1, 25'600), "unknown_unit");
}

TEST_F(AxisQuantity, AnEncoderInCountsIsSetAndToldInTheUnit) {
  x.model = find_model("TMCM-3110");
  const auto& row = *find_parameter(x.parameters(), "encoder_position");
  EXPECT_EQ(from_parameter(1200, x, row)->number, 1200 / 10'240.0) << "in microsteps";
  x.encoder_counts_per_unit = 1200;
  EXPECT_EQ(from_parameter(1200, x, row), (Quantity{1, "mm"}));
  EXPECT_EQ(to_parameter(parsed("2.5mm"), x, row), 3000);
  EXPECT_EQ(to_parameter(parsed("0.25cm"), x, row), 3000);
  const auto turn = to_parameter(parsed("1rev"), x, row);
  EXPECT_THAT(turn.error().message, HasSubstr("counts of the encoder"));
}

TEST(ParseQuantity, TakesHexadecimalNumbersAsTheyAre) {
  EXPECT_EQ(parsed("0x43"), (Quantity{67, ""}));
  EXPECT_EQ(parsed("$43"), (Quantity{67, ""}));
  EXPECT_EQ(parsed("0xFFFFFFFF"), (Quantity{-1, ""}));
  EXPECT_EQ(error_in("0x43mm").code, Errc::two_units);
  EXPECT_EQ(error_in("0x1FFFFFFFF").code, Errc::two_units);
}

TEST(Quantity, SignsOfKeyboardsAndOfTypesettersAreRead) {
  const auto same = [](std::string_view one, std::string_view other) {
    const AxisUnits units{
        "x", find_model("TMCM-1110"), ModuleUnits{}, UserScale{"mm", 2, false, {200, 8}}, {}, {}};
    const auto first = parse_quantity(one);
    const auto second = parse_quantity(other);
    ASSERT_TRUE(first && second) << one;
    ASSERT_EQ(dimension_of(*first), dimension_of(*second)) << one;
    if (dimension_of(*first) == Dimension::position) {
      const auto read = to_microsteps(*first, units, {});
      ASSERT_TRUE(read) << one << ": " << read.error().message;
      EXPECT_EQ(*read, to_microsteps(*second, units, {}).value_or(Microsteps{})) << one;
    } else {
      EXPECT_EQ(to_pps2(*first, units)->value, to_pps2(*second, units)->value) << one;
    }
  };
  same("100\u00B5m", "100um");
  same("100\u03BCm", "100um");
  same("\u22125mm", "-5mm");
  same("5\u00A0mm", "5 mm");
  same("5\u202F\u00B5m", "5 um");
  same("5mm/s\u00B2", "5mm/s^2");
  const AxisUnits degrees{
      "r", find_model("TMCM-1110"), {}, UserScale{"deg", 360, false, {200, 8}}, {}, {}};
  const auto microsteps = [&](std::string_view text) {
    const auto value = to_microsteps(*parse_quantity(text), degrees, {});
    return value ? value->value : -1;
  };
  EXPECT_EQ(microsteps("12\u00B0"), microsteps("12deg"));
}

}  // namespace
}  // namespace tmcl::test
