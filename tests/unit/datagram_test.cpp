// The bytes of datagrams that manuals print, and the tables of names.

#include "tmcl/datagram.hpp"

#include <gmock/gmock.h>

#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/serial_decoder.hpp"
#include "tmcl/spelling.hpp"
#include "tmcl/units.hpp"
#include "tmcl/version.hpp"

namespace tmcl {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// TMCM-6212 manual, CALC MUL -5000; the checksums are those that the rule gives.
static_assert(encode_serial(Request{ModuleAddress{1}, Command::CALC, 2, 0, -5000}) ==
              SerialBytes{0x01, 0x13, 0x02, 0x00, 0xFF, 0xFF, 0xEC, 0x78, 0x78});
static_assert(encode_serial(Reply{2, 1, Status::ok, Command::CALC, -5000}) ==
              SerialBytes{0x02, 0x01, 0x64, 0x13, 0xFF, 0xFF, 0xEC, 0x78, 0xDC});
static_assert(encode_serial(Request{ModuleAddress{1}, Command::CALCXV, 1, 27, 0})[8] == 0x49);
static_assert(encode_serial(Reply{2, 1, Status::ok, Command::GET_FIRMWARE_VERSION,
                                  0x04560101})[8] == 0x4B);
static_assert(version_from_value(0x04560101) == FirmwareVersion{1110, 1, 1});
static_assert(to_value({1110, 1, 1}) == 0x04560101);

TEST(Datagram, OnCanTheAddressIsTheIdentifier) {
  const auto frame = encode_can(Request{ModuleAddress{0x123}, Command::MVP, 0, 2, -1});
  EXPECT_EQ(frame.id, 0x123U);
  EXPECT_EQ(frame.length, 7);
  EXPECT_THAT(frame.data, ElementsAre(4, 0, 2, 0xFF, 0xFF, 0xFF, 0xFF, 0));
}

TEST(Datagram, ShortCanFramesAreNoDatagrams) {
  EXPECT_FALSE(decode_can_request({1, false, 6, {}}));
  EXPECT_FALSE(decode_can_reply({2, false, 6, {}}));
  EXPECT_FALSE(decode_can_request({0x800, true, 7, {}}));
}

TEST(Version, TextAndBack) {
  const auto text = to_text({1110, 1, 1});
  EXPECT_EQ(std::string_view(text.data(), text.size()), "1110V101");
  EXPECT_EQ(version_from_text("1110V101"), (FirmwareVersion{1110, 1, 1}));
  EXPECT_EQ(version_from_text("6110V10"), (FirmwareVersion{6110, 1, 0}));
  EXPECT_EQ(version_from_text("142V1.06"), (FirmwareVersion{142, 1, 6}));
  const auto bootloader = to_text({1110, 1, 1, true});
  EXPECT_EQ(std::string_view(bootloader.data(), bootloader.size()), "1110B101");
  EXPECT_EQ(version_from_text("1110B101"), (FirmwareVersion{1110, 1, 1, true}));
  for (const auto* bad : {"", "1110V1", "1110V1011", "1110v101", "11x0V101", "1110V-01", "1110V.01",
                          "142V10.6", "142V1..6"}) {
    EXPECT_FALSE(version_from_text(bad)) << bad;
  }
  EXPECT_EQ(to_string(FirmwareVersion{1110, 1, 1}), "1.01");
}

TEST(SerialDecoder, UnderstandsTheVersionTextOnlyWhenAsked) {
  const std::array<std::uint8_t, 9> bytes{2, '1', '1', '1', '0', 'V', '1', '0', '1'};
  SerialDecoder decoder;
  for (const auto byte : bytes) EXPECT_FALSE(decoder.push(byte));
  decoder.reset();
  decoder.expect_version_text(true);
  std::optional<SerialItem> item;
  for (const auto byte : bytes) item = decoder.push(byte);
  ASSERT_TRUE(item);
  EXPECT_EQ(std::get<VersionText>(*item).version, (FirmwareVersion{1110, 1, 1}));
}

TEST(SerialDecoder, DropsRepliesForAnotherHost) {
  SerialDecoder decoder(2);
  for (const auto byte : encode_serial(Reply{3, 1, Status::ok, Command::GAP, 5}))
    EXPECT_FALSE(decoder.push(byte));
}

TEST(Commands, EveryNameLeadsBackToItsNumber) {
  for (const auto& row : command_table()) {
    EXPECT_EQ(parse_command(row.name), row.command);
    EXPECT_EQ(name_of(row.command), row.name);
  }
  EXPECT_EQ(parse_command("gap"), Command::GAP);
  EXPECT_EQ(parse_command("6"), Command::GAP);
  EXPECT_FALSE(parse_command("GAPP"));
  EXPECT_FALSE(parse_command("256"));
  EXPECT_EQ(name_of(static_cast<Command>(99)), "99");
  EXPECT_EQ(parse_subtype(Command::MVP, "rel"), 1);
}

TEST(Commands, WhatMayMoveIsNeverRepeated) {
  for (int number = 0; number < 256; ++number) {
    const auto command = static_cast<Command>(number);
    for (int type = 0; type < 256; ++type) {
      if (effect_of(command, static_cast<std::uint8_t>(type)) != Effect::moves) continue;
      ASSERT_EQ(repeat_rule(command, static_cast<std::uint8_t>(type)), Repeat::never)
          << number << ", " << type;
    }
  }
}

TEST(Statuses, AreNamedAndExplained) {
  for (const auto& row : status_table()) {
    EXPECT_EQ(name_of(row.status), row.name);
    EXPECT_EQ(row.hint.empty(), is_success(row.status)) << row.name;
  }
  EXPECT_EQ(name_of(static_cast<Status>(77)), "unknown_status");
}

TEST(Parameters, GoByStandardNameRegisterNameAndNumber) {
  const auto table = axis_parameters(*find_model(1110));
  for (const auto& row : table) {
    EXPECT_EQ(find_parameter(table, row.number), &row);
    EXPECT_EQ(find_parameter(table, row.name), &row);
    for (const auto alias : row.aliases) {
      if (alias.empty()) continue;
      EXPECT_EQ(find_parameter(table, alias), &row) << alias;
    }
  }
  EXPECT_EQ(find_parameter(table, "MaxVelocity")->number, 4);
  EXPECT_EQ(find_parameter(table, "v_max")->number, 4);
  EXPECT_EQ(find_parameter(table, "nonsense"), nullptr);
}

TEST(Models, AreFoundByAnyOfTheirNames) {
  for (const auto* name : {"TMCM-3110", "tmcm3110", "3110"}) {
    ASSERT_NE(find_model(name), nullptr) << name;
    EXPECT_EQ(find_model(name)->axes, 3);
  }
  EXPECT_EQ(find_model("TMCM-9999"), nullptr);
  EXPECT_EQ(find_model(std::uint16_t{6110})->axes, 6);
}

TEST(Nearest, SuggestsWhatWasMeantAndNothingElse) {
  const std::array<std::string_view, 3> words{"max_velocity", "max_acceleration", "ramp_mode"};
  EXPECT_EQ(closest_word("max_velocty", words), "max_velocity");
  EXPECT_EQ(did_you_mean("rampmode", words), " Did you mean 'ramp_mode'?");
  EXPECT_THAT(did_you_mean("xyz", words), IsEmpty());
  EXPECT_EQ(closest_word("Velocity", words), "max_velocity");
  EXPECT_EQ(closest_word("mode", words), "ramp_mode");
  EXPECT_EQ(closest_word("elocity", words), "");
  EXPECT_EQ(
      closest_word("velocity", std::array<std::string_view, 2>{"max_velocity", "stall_velocity"}),
      "");
}

TEST(Nearest, IsAWordMistypedAndNoOtherOne) {
  const auto meant = [](std::string_view word, std::string_view candidate) {
    return !closest_word(word, std::array{candidate}).empty();
  };
  for (const auto& [word, candidate] :
       std::initializer_list<std::pair<const char*, const char*>>{{"mvoe", "move"},
                                                                  {"stge", "stage"},
                                                                  {"MM", "mm"},
                                                                  {"deamon", "daemon"},
                                                                  {"nmae", "name"},
                                                                  {"--jsno", "--json"},
                                                                  {"rotat", "rotate"},
                                                                  {"st", "state"},
                                                                  {"stpo", "stop"}})
    EXPECT_TRUE(meant(word, candidate)) << word;
  for (const auto& [word, candidate] :
       std::initializer_list<std::pair<const char*, const char*>>{{"version", "verify"},
                                                                  {"tune", "line"},
                                                                  {"list", "line"},
                                                                  {"--also", "--json"},
                                                                  {"--all", "--url"},
                                                                  {"home", "move"},
                                                                  {"halt", "wait"},
                                                                  {"x", "y"},
                                                                  {"-", "--all"}})
    EXPECT_FALSE(meant(word, candidate)) << word;
}

TEST(Units, MatchTheFiguresOfTheDataSheet) {
  EXPECT_NEAR(to_pps({1000}, Tmc429Dividers{.pulse = 2, .ramp = 3}).value, 61'035, 1);
  EXPECT_NEAR(to_pps2({500}, Tmc429Dividers{.pulse = 2, .ramp = 3}).value, 7.45e6, 0.01e6);
  EXPECT_NEAR(to_pps({2047}, Tmc429Dividers{}).value, 499'756, 1);
}

}  // namespace
}  // namespace tmcl
