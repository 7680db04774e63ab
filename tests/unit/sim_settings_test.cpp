// What a module can be set to be: its firmware's version, whom it is like where the manual and the
// vendor's example firmware TMCL-LITE do not agree, and what becomes of values out of range.
#include <gmock/gmock.h>

#include <map>
#include <string>

#include "sim/module/wrapping.hpp"
#include "sim_fixture.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr auto magic = static_cast<std::int32_t>(0xA3B4C5D6);

class SimSettings : public SimTest {
 protected:
  Module& add_with(const ModuleSettings& settings, std::uint16_t model = 1110) {
    return bench.add(*find_model(model), ModuleAddress{1}, settings);
  }
  static ModuleSettings wrapping() {
    ModuleSettings settings;
    settings.traits.set(Trait::range_check, RangeCheck::wrap);
    return settings;
  }
  std::string version_text() {
    const auto request = encode_serial(Request{ModuleAddress{1}, Command::GET_FIRMWARE_VERSION});
    const auto bytes = exchange(Bytes(request.begin(), request.end()));
    return {bytes.begin() + 1, bytes.end()};
  }
  std::uint32_t value_of(Command command, std::uint8_t type) {
    return static_cast<std::uint32_t>(ask(command, type, 0)->value);
  }
  Status set(std::uint8_t parameter, std::int32_t value) {
    return status_of(Command::SAP, parameter, 0, value);
  }
};

// ---- Firmware

TEST_F(SimSettings, TheVersionOfEveryModelCanBeSaidAsTextAndAsNumbers) {
  for (const auto& model : models()) {
    const auto version = Module(model, ModuleAddress{1}, clock).version();
    EXPECT_EQ(version.model, model.number);
    EXPECT_EQ(version_from_value(to_value(version)), version) << model.name;
    const auto text = to_text(version);
    EXPECT_EQ(version_from_text({text.data(), text.size()}), version) << model.name;
  }
}

TEST_F(SimSettings, ModelsHaveTheFirmwareOfTheirManuals) {
  const std::map<std::uint16_t, FirmwareRelease> known{
      {351, {4, 45}},  {1021, {1, 42}}, {1110, {1, 13}}, {1140, {1, 47}}, {1161, {1, 46}},
      {1211, {1, 10}}, {1276, {1, 13}}, {1278, {1, 15}}, {3110, {1, 14}}, {6110, {1, 46}}};
  for (const auto& [model, release] : known) {
    EXPECT_EQ(delivered_firmware(*find_model(model)), release) << model;
  }
}

TEST_F(SimSettings, CommandsAgreeOnTheVersionThatIsSet) {
  add_with({.firmware = FirmwareRelease{1, 9}}, 3110);
  EXPECT_EQ(version_text(), "3110V109");
  EXPECT_EQ(value_of(Command::GET_FIRMWARE_VERSION, 1), 3110U << 16 | 0x0109U);
  EXPECT_EQ(value_of(Command::GET_INFO, 1), 0x00010009U);
}

TEST_F(SimSettings, TheSetVersionIsThatOfTheFirmwareAndNotOfTheBootloader) {
  auto& module = add_with({.firmware = FirmwareRelease{2, 50}});
  EXPECT_EQ(ask(Command::ENTER_BOOTLOADER, 0x81, 0x92, magic), std::nullopt);
  pass(Module::boot_time);
  EXPECT_EQ(version_text(), "1110B101");
  EXPECT_EQ(ask(Command::BOOT_START_APPLICATION, 0, 0), std::nullopt);
  pass(Module::boot_time);
  EXPECT_EQ(version_text(), "1110V250");
  EXPECT_EQ(value_of(Command::GET_INFO, 11), 0x00010001U);
  module.power_cycle();
  pass(Module::boot_time);
  EXPECT_EQ(version_text(), "1110V250");
}

// ---- Behaviour

TEST_F(SimSettings, AWrongCodeForAResetIsRefusedAsTheManualHasIt) {
  add_with({});
  EXPECT_EQ(status_of(Command::SOFTWARE_RESET, 0, 0, 1233), Status::invalid_value);
  EXPECT_EQ(status_of(Command::ENTER_BOOTLOADER, 0, 0, 0), Status::wrong_type);
}

TEST_F(SimSettings, TmclLiteIgnoresAWrongCodeForAReset) {
  add_with({.behaviour = Behaviour::lite});
  set(ap::max_velocity, 99);
  EXPECT_EQ(ask(Command::SOFTWARE_RESET, 0, 0, 1233)->value, 1233);
  EXPECT_EQ(status_of(Command::SOFTWARE_RESET, 7, 7, 0), Status::ok);
  EXPECT_EQ(get(ap::max_velocity), 99) << "it has not started again";
  EXPECT_EQ(status_of(Command::SOFTWARE_RESET, 0, 0, 1234), Status::ok);
  pass(Module::boot_time);
  EXPECT_EQ(get(ap::max_velocity), 1000);
}

TEST_F(SimSettings, TmclLiteIgnoresWrongCodesForItsBootloader) {
  add_with({.behaviour = Behaviour::lite});
  EXPECT_EQ(status_of(Command::ENTER_BOOTLOADER, 0, 0x92, magic), Status::ok);
  EXPECT_EQ(status_of(Command::ENTER_BOOTLOADER, 0x81, 0, magic), Status::ok);
  EXPECT_EQ(ask(Command::ENTER_BOOTLOADER, 0x81, 0x92, 1)->value, 1);
  EXPECT_EQ(version_text(), "1110V113");
  EXPECT_EQ(ask(Command::ENTER_BOOTLOADER, 0x81, 0x92, magic), std::nullopt);
  pass(Module::boot_time);
  EXPECT_EQ(version_text(), "1110B101");
}

TEST_F(SimSettings, TmclLiteRefusesWhatItRefusesElsewhere) {
  add_with({.behaviour = Behaviour::lite});
  EXPECT_EQ(status_of(Command::SAP, 99, 0, 0), Status::wrong_type);
  EXPECT_EQ(set(ap::max_velocity, 2048), Status::invalid_value);
}

// ---- Ranges

class SimWrapping : public SimSettings {
 protected:
  SimWrapping() : module(add_with(wrapping())) {}
  std::uint32_t chip(std::uint8_t address) { return value_of(Command::READ_MC, address); }
  Module& module;
};

TEST_F(SimSettings, ValuesOutOfRangeAreRefusedAsTheManualHasIt) {
  add_with({});
  EXPECT_EQ(set(ap::max_acceleration, 2048), Status::invalid_value);
  EXPECT_EQ(status_of(Command::ROL, 0, 0, 3000), Status::invalid_value);
  EXPECT_EQ(status_of(Command::MVP, 0, 0, 1 << 23), Status::invalid_value);
}

TEST_F(SimWrapping, VelocityAndAccelerationAreRememberedAndTheChipGetsElevenBits) {
  EXPECT_EQ(set(ap::max_acceleration, 2048), Status::ok);
  EXPECT_EQ(get(ap::max_acceleration), 2048);
  EXPECT_EQ(chip(0x0C), 0U);
  EXPECT_EQ(set(ap::max_velocity, 5000), Status::ok);
  EXPECT_EQ(get(ap::max_velocity), 5000);
  EXPECT_EQ(chip(0x06), 5000U & 0x7FFU);
  EXPECT_EQ(set(ap::max_velocity, 300), Status::ok);
  EXPECT_EQ(get(ap::max_velocity), 300);
}

TEST_F(SimWrapping, ThePositioningAfterARotationHasTheCutVelocityAgain) {
  set(ap::max_velocity, 2048 + 100);
  ask(Command::ROR, 0, 0, 500);
  pass(std::chrono::seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 500);
  ask(Command::MVP, 0, 0, 8'000'000);
  pass(std::chrono::seconds(2));
  EXPECT_EQ(get(ap::actual_velocity), 100);
}

TEST_F(SimWrapping, AReferenceSearchAtFullSpeedTurnsAtTheCutVelocity) {
  set(ap::max_velocity, 2048 + 100);
  set(number_of("reference_search_speed"), 0);
  EXPECT_EQ(status_of(Command::RFS, 0, 0), Status::ok);
  pass(std::chrono::seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), -100);
}

TEST_F(SimWrapping, RotationsAreOfTwelveBitsWithASign) {
  EXPECT_EQ(ask(Command::ROL, 0, 0, 3000)->value, 3000);
  EXPECT_EQ(get(ap::target_velocity), 4096 - 3000) << "it turns right";
  ask(Command::ROR, 0, 0, 3000);
  EXPECT_EQ(get(ap::target_velocity), 3000 - 4096);
  ask(Command::ROR, 0, 0, 2048);
  EXPECT_EQ(get(ap::target_velocity), -2047);
  EXPECT_EQ(set(ap::target_velocity, 4096 + 5), Status::ok);
  EXPECT_EQ(get(ap::target_velocity), 5);
  ask(Command::ROL, 0, 0, INT32_MIN);
  EXPECT_EQ(get(ap::target_velocity), 0);
}

TEST_F(SimWrapping, PositionsAreOfTwentyFourBitsWithASign) {
  EXPECT_EQ(status_of(Command::MVP, 0, 0, (1 << 24) + 700), Status::ok);
  EXPECT_EQ(get(ap::target_position), 700);
  EXPECT_EQ(set(ap::actual_position, 1 << 23), Status::ok);
  EXPECT_EQ(get(ap::actual_position), -(1 << 23));
  EXPECT_EQ(set(ap::target_position, INT32_MIN), Status::ok);
  EXPECT_EQ(get(ap::target_position), 0);
  set(ap::actual_position, 5);
  EXPECT_EQ(status_of(Command::MVP, 1, 0, (1 << 25) + 10), Status::ok);
  EXPECT_EQ(get(ap::target_position), 15);
}

TEST_F(SimWrapping, CurrentsAreBytes) {
  EXPECT_EQ(ask(Command::SAP, number_of("max_current"), 0, 1000)->value, 1000);
  EXPECT_EQ(get(number_of("max_current")), 1000 & 0xFF);
  set(number_of("standby_current"), -1);
  EXPECT_EQ(get(number_of("standby_current")), 255);
}

struct Write {
  std::uint8_t parameter;
  std::int32_t value;
  std::int32_t reads;
};

TEST_F(SimWrapping, OtherRegistersAndBytesKeepWhatFits) {
  const Write writes[] = {
      {12, 256, 0},    {12, 2, 1},      {13, 255, 1},  {130, 2049, 1}, {138, 3, 3},
      {138, 6, 2},     {141, 4097, 1},  {149, 256, 1}, {153, 21, 5},   {154, -12, 4},
      {160, 2, 2},     {160, 256, 0},   {161, 3, 3},   {162, 9, 3},    {163, 4, 4},
      {164, 2, 2},     {166, 9, 7},     {167, 16, 15}, {168, -1, 1},   {169, 256, 0},
      {170, 300, 15},  {171, 5, 3},     {172, 20, 20}, {173, 3, 3},    {174, 127, 63},
      {174, 200, -56}, {174, 128, -63}, {177, 2, 2},   {179, 257, 1},  {181, 5000, 5000},
      {182, -1, -1},   {183, 257, 1},   {184, 258, 2},
  };
  for (const auto& write : writes) {
    EXPECT_EQ(set(write.parameter, write.value), Status::ok) << int{write.parameter};
    EXPECT_EQ(get(write.parameter), write.reads)
        << int{write.parameter} << " set to " << write.value;
  }
}

TEST_F(SimWrapping, WhatNobodyKnowsIsRefused) {
  const Write writes[] = {{140, 9, 8},     {153, 14, 3}, {154, 15, 2},     {165, 13, 0},
                          {175, 4, 0},     {178, 4, 0},  {194, 3000, 500}, {204, 65536, 0},
                          {212, 65536, 0}, {214, 0, 200}};
  for (const auto& write : writes) {
    const auto before = get(write.parameter);
    EXPECT_EQ(set(write.parameter, write.value), Status::invalid_value) << int{write.parameter};
    EXPECT_EQ(get(write.parameter), before) << int{write.parameter};
  }
  EXPECT_EQ(set(ap::position_reached, 1), Status::wrong_type);
}

TEST_F(SimWrapping, WhatIsInRangeIsTakenAsItIs) {
  for (const auto& row : axis_parameters(module.model())) {
    if (row.access == Access::read || row.number == ap::actual_position) continue;
    for (const auto value : {row.minimum, row.maximum}) {
      EXPECT_EQ(set(row.number, value), Status::ok) << row.name;
      if (row.number == ap::target_velocity) continue;
      EXPECT_EQ(get(row.number), value) << row.name;
    }
  }
}

TEST_F(SimWrapping, AStoredValueWrapsAgainAtTheNextStart) {
  set(ap::max_velocity, 5000);
  ask(Command::STAP, ap::max_velocity, 0);
  module.power_cycle();
  pass(Module::boot_time);
  EXPECT_EQ(get(ap::max_velocity), 5000);
  EXPECT_EQ(chip(0x06), 5000U & 0x7FFU);
}

TEST_F(SimWrapping, AStallVelocityHasNoSign) {
  module.at_stage(0, [](Stage& stage) { stage.set_load(600); });
  set(number_of("smart_energy_stall_velocity"), -1);
  ask(Command::ROR, 0, 0, 1000);
  pass(std::chrono::seconds(2));
  EXPECT_EQ(get(ap::actual_velocity), 1000) << "no speed is above that";
}

TEST_F(SimSettings, OtherFamiliesRefuseWhateverIsSet) {
  add_with(wrapping(), 6212);
  EXPECT_EQ(set(number_of("max_current"), 1000), Status::invalid_value);
  EXPECT_FALSE(concerns(Trait::range_check, *find_model(6212)));
  EXPECT_TRUE(concerns(Trait::range_check, *find_model(351)));
}

}  // namespace
}  // namespace tmcl::sim
