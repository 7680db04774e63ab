// What a module can be set to be: its firmware's version, whom it is like where the manual and the
// vendor's example firmware TMCL-LITE do not agree.
#include <gmock/gmock.h>

#include <map>
#include <string>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr auto magic = static_cast<std::int32_t>(0xA3B4C5D6);

class SimSettings : public SimTest {
 protected:
  Module& add_with(const ModuleSettings& settings, std::uint16_t model = 1110) {
    return bench.add(*find_model(model), ModuleAddress{1}, settings);
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

}  // namespace
}  // namespace tmcl::sim
