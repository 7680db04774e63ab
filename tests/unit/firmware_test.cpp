// Firmware images: Intel HEX files, and the module that an image is for.
#include "tmcl/firmware.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/intel_hex.hpp"

namespace tmcl::firmware {
namespace {

using test::hex_base;
using test::hex_end;
using test::hex_file;
using test::hex_record;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Bytes = std::vector<std::uint8_t>;

std::string data(std::uint16_t offset, const Bytes& bytes) { return hex_record(0, offset, bytes); }

TextProblem problem_of(const std::string& text) {
  const auto image = read_intel_hex(text);
  EXPECT_FALSE(image) << text;
  return image ? TextProblem{} : image.error();
}

TEST(IntelHex, DataBecomesAnImageAtItsAddress) {
  const auto image = read_intel_hex(hex_base(0x08000000) + data(0x4000, {1, 2, 3}) + hex_end);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->start, 0x08004000U);
  EXPECT_THAT(image->bytes, ElementsAre(1, 2, 3));
  EXPECT_EQ(address_text(image->start), "0x08004000");
}

TEST(IntelHex, AFileOfManyRecordsIsReadAsItWasWritten) {
  const auto bytes = test::firmware_bytes(0x12345, "1110V142");
  const auto image = read_intel_hex(hex_file(0xFFF8, bytes));
  ASSERT_TRUE(image) << describe(image.error(), "x.hex");
  EXPECT_EQ(image->start, 0xFFF8U);
  EXPECT_EQ(image->bytes, bytes);
}

TEST(IntelHex, OrderLineEndsAndLowerCaseDoNotMatter) {
  auto lower = data(0x20, {0xAB, 0xCD});
  for (auto& c : lower) c = c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
  lower.insert(lower.size() - 1, "\r");
  const auto image = read_intel_hex("\n" + lower + data(0x1E, {1, 2}) + "\r\n" + hex_end + " \n\n");
  ASSERT_TRUE(image) << describe(image.error(), "x.hex");
  EXPECT_EQ(image->start, 0x1EU);
  EXPECT_THAT(image->bytes, ElementsAre(1, 2, 0xAB, 0xCD));
}

TEST(IntelHex, GapsAreFilledWithWhatErasedMemoryHolds) {
  const auto image = read_intel_hex(data(0x10, {1}) + data(0x14, {5}) + hex_end);
  ASSERT_TRUE(image);
  EXPECT_THAT(image->bytes, ElementsAre(1, 0xFF, 0xFF, 0xFF, 5));
  EXPECT_EQ(checksum(*image), 1U + 3 * 0xFF + 5);
}

TEST(IntelHex, SegmentsAreSixteenBytesApart) {
  const auto image =
      read_intel_hex(hex_record(2, 0, Bytes{0x12, 0x34}) + data(0x0005, {7}) +
                     hex_record(2, 0, Bytes{0x12, 0x35}) + data(0xFFF6 - 0xFFF0, {8}) + hex_end);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->start, 0x12345U);
  EXPECT_EQ(image->bytes.size(), 0x12U);
  EXPECT_EQ(image->bytes.back(), 8);
}

TEST(IntelHex, StartAddressesMeanNothing) {
  const auto image = read_intel_hex(hex_record(3, 0, Bytes{0, 1, 2, 3}) + data(0, {9}) +
                                    hex_record(5, 0, Bytes{8, 0, 0x40, 1}) + hex_end);
  ASSERT_TRUE(image);
  EXPECT_THAT(image->bytes, ElementsAre(9));
}

TEST(IntelHex, ALinearRecordMayCrossSixtyFourKilobytes) {
  const auto image = read_intel_hex(hex_base(0x10000) + data(0xFFFF, {1, 2}) + hex_end);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->start, 0x1FFFFU);
}

TEST(IntelHex, WhatIsWrongIsToldWithLineAndColumn) {
  const auto first = data(0, {1, 2, 3, 4});
  struct Case {
    std::string text;
    std::size_t line;
    std::size_t column;
    std::string word;
    std::string message;
  };
  const std::vector<Case> cases{
      {first + "S1130000" + "\n", 2, 1, "S", "a record begins with ':', not with 'S'"},
      {":0400000001020G04F2\n", 1, 15, "G", "'G' is no hexadecimal digit"},
      {":0400000001020304F\n", 1, 18, "", "half a byte is missing"},
      {":0400000001020304\n", 1, 2, "04", "should have 9 bytes and has 8"},
      {":\n", 1, 2, "", "should have 5 bytes and has 0"},
      {":0400000001020304F3\n", 1, 18, "F3", "wrong checksum F3; the bytes before it give F2"},
      {first + hex_record(6, 0, {}), 2, 8, "06", "there is no record type 06"},
      {hex_record(4, 0, Bytes{1}), 1, 2, "01", "a record of type 04 has 2 bytes of data, not 1"},
      {hex_record(1, 0, Bytes{1}), 1, 2, "01", "a record of type 01 has 0 bytes of data, not 1"},
      {first + data(3, {9}), 2, 10, "", "there is data for 0x00000003 already, from line 1"},
      {data(8, {9}) + data(6, {1, 2, 3}), 2, 10, "", "0x00000006 already, from line 1"},
      {hex_record(2, 0, Bytes{0x10, 0}) + data(0xFFFF, {1, 2}), 2, 10, "", "end of its segment"},
      {hex_base(0xFFFF0000) + data(0xFFFF, {1, 2}), 2, 10, "", "the last address, 0xFFFFFFFF"},
      {first + hex_base(0x10000000) + first, 3, 10, "",
       "at most 4194304 bytes; from 0x00000000 to 0x10000003 there are more"},
      {first + hex_end + first, 3, 1, ":0400000001020304F2", "nothing may follow the end record"},
      {first, 0, 0, "", "there is no end record; the file seems to be cut short"},
      {hex_end, 0, 0, "", "there is no data in it"},
      {"", 0, 0, "", "there is no end record"},
      {std::string(most_file_bytes + 1, ' '), 0, 0, "", "the file has more than 16000000 bytes"},
  };
  for (const auto& expected : cases) {
    const auto problem = problem_of(expected.text);
    EXPECT_EQ(problem.line, expected.line) << expected.message;
    EXPECT_EQ(problem.column, expected.column) << expected.message;
    EXPECT_EQ(problem.word, expected.word) << expected.message;
    EXPECT_THAT(problem.message, HasSubstr(expected.message));
  }
}

TEST(IntelHex, ProblemsAreToldLikeThoseOfACompiler) {
  EXPECT_EQ(describe({3, 4, "wrong"}, "a.hex"), "a.hex:3:4: wrong");
  EXPECT_EQ(describe({0, 0, "wrong"}, "a.hex"), "a.hex: wrong");
}

TEST(IntelHex, EveryDamagedByteOfARecordIsFound) {
  const auto good = data(0x1234, {0x10, 0x20, 0x30}) + hex_end;
  for (std::size_t at = 0; at < good.find('\n'); ++at) {
    auto bad = good;
    bad[at] = bad[at] == '5' ? '6' : '5';
    EXPECT_FALSE(read_intel_hex(bad)) << bad;
  }
}

TEST(FirmwareIdentity, TheVersionStandsAmongTheBytes) {
  const Image image{0x4000, test::firmware_bytes(1000, "1110V142")};
  EXPECT_THAT(versions_in(image), ElementsAre(FirmwareVersion{1110, 1, 42}));
  EXPECT_EQ(version_for(image, 1110), (FirmwareVersion{1110, 1, 42}));
  EXPECT_EQ(version_for(image, 3110), std::nullopt);
}

TEST(FirmwareIdentity, TheFormOfThreeDigitModelsCountsToo) {
  EXPECT_EQ(version_for({0, test::firmware_bytes(64, "142V1.06")}, 142),
            (FirmwareVersion{142, 1, 6}));
  EXPECT_EQ(version_for({0, test::firmware_bytes(64, "0142V106")}, 142),
            (FirmwareVersion{142, 1, 6}));
}

TEST(FirmwareIdentity, ABootloadersVersionIsNotTheFirmwares) {
  EXPECT_THAT(versions_in({0, test::firmware_bytes(64, "1110B101")}), IsEmpty());
}

TEST(FirmwareIdentity, EachVersionIsToldOnceAndNotTooMany) {
  Image image;
  for (int i = 0; i < 40; ++i) {
    const auto text = to_text({1110, 1, static_cast<std::uint8_t>(i / 2)});
    image.bytes.insert(image.bytes.end(), text.begin(), text.end());
  }
  EXPECT_EQ(versions_in(image).size(), most_versions);
  EXPECT_EQ(versions_in(image)[1], (FirmwareVersion{1110, 1, 1}));
}

TEST(FirmwareIdentity, AVersionAtEitherEndIsFound) {
  EXPECT_TRUE(version_for({0, {'1', '1', '1', '0', 'V', '1', '0', '1'}}, 1110));
  EXPECT_THAT(versions_in({0, {'1', '1', '1', '0', 'V', '1', '0'}}), IsEmpty());
}

}  // namespace
}  // namespace tmcl::firmware
