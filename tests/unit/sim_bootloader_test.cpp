// The bootloader of a simulated module, command by command.
#include "sim/module/bootloader.hpp"

#include <gtest/gtest.h>

#include "sim_fixture.hpp"
#include "support/intel_hex.hpp"

namespace tmcl::sim {
namespace {

constexpr FirmwareVersion factory{1110, 1, 1};

class SimBootloader : public testing::Test {
 protected:
  Answer ask(Command command, std::uint8_t type = 0, std::uint8_t motor = 0,
             std::uint32_t value = 0) {
    return bootloader.execute(
        {ModuleAddress{1}, command, type, motor, static_cast<std::int32_t>(value)});
  }
  std::uint32_t value_of(Command command, std::uint8_t type = 0, std::uint32_t value = 0) {
    const auto answer = ask(command, type, 0, value);
    EXPECT_EQ(answer.status, Status::ok);
    return static_cast<std::uint32_t>(answer.value);
  }
  Status status_of(Command command, std::uint8_t type = 0, std::uint8_t motor = 0,
                   std::uint32_t value = 0) {
    return ask(command, type, motor, value).status;
  }
  /// As PyTrinamic's tmclfwupload does it; `old` writes length and sum as older tools do.
  void upload(const std::vector<std::uint8_t>& bytes, bool old = false) {
    ask(Command::BOOT_ERASE_ALL);
    std::uint32_t sum = 0;
    for (std::uint32_t at = 0; at < bytes.size(); at += 4) {
      std::uint32_t word = 0;
      for (std::uint32_t i = 0; i < 4 && at + i < bytes.size(); ++i) {
        word |= std::uint32_t{bytes[at + i]} << 8U * i;
        sum += bytes[at + i];
      }
      const auto index = at % Flash::page_size / 4;
      ask(Command::BOOT_WRITE_BUFFER, static_cast<std::uint8_t>(index), 0, word);
      const bool last_of_page = index == Flash::page_size / 4 - 1 || at + 4 >= bytes.size();
      if (last_of_page) ask(Command::BOOT_WRITE_PAGE, 0, 0, Flash::start + at);
    }
    const auto length = static_cast<std::uint32_t>(bytes.size());
    if (old) {
      ask(Command::BOOT_WRITE_BUFFER, 126, 0, length);
      ask(Command::BOOT_WRITE_BUFFER, 127, 0, sum);
      ask(Command::BOOT_WRITE_PAGE, 0, 0, Flash::size - Flash::page_size);
    } else {
      ask(Command::BOOT_WRITE_LENGTH, 0, 0, length);
      ask(Command::BOOT_WRITE_LENGTH, 1, 0, sum);
    }
  }

  Bootloader bootloader{1110, factory};
};

TEST_F(SimBootloader, ComesWithAFirmware) {
  EXPECT_TRUE(bootloader.has_firmware());
  EXPECT_EQ(bootloader.firmware_version({}), factory);
}

TEST_F(SimBootloader, TellsItsVersionWithABAsTextAndTheModelAsNumber) {
  EXPECT_EQ(ask(Command::GET_FIRMWARE_VERSION, 0).form, Answer::Form::version_text);
  EXPECT_EQ(bootloader.version(), (FirmwareVersion{1110, 1, 1, true}));
  EXPECT_EQ(value_of(Command::GET_FIRMWARE_VERSION, 1), 0x04560101U);
  EXPECT_EQ(status_of(Command::GET_FIRMWARE_VERSION, 2), Status::wrong_type);
}

TEST_F(SimBootloader, TellsItsMemory) {
  EXPECT_EQ(value_of(Command::BOOT_GET_INFO, 0), Flash::page_size);
  EXPECT_EQ(value_of(Command::BOOT_GET_INFO, 1), Flash::start);
  EXPECT_EQ(value_of(Command::BOOT_GET_INFO, 2), Flash::size);
  EXPECT_EQ(status_of(Command::BOOT_GET_INFO, 3), Status::wrong_type);
}

TEST_F(SimBootloader, ErasedThereIsNoFirmware) {
  ask(Command::BOOT_ERASE_ALL);
  EXPECT_FALSE(bootloader.has_firmware());
  EXPECT_EQ(value_of(Command::BOOT_READ_MEMORY, 0, Flash::start), 0xFFFFFFFFU);
  EXPECT_EQ(value_of(Command::BOOT_GET_CHECKSUM, 0, Flash::start + 3), 4U * 0xFF);
}

TEST_F(SimBootloader, TakesWhatToolsUpload) {
  for (const bool old : {false, true}) {
    const auto bytes = test::firmware_bytes(1300, "1110V142");
    upload(bytes, old);
    EXPECT_TRUE(bootloader.has_firmware());
    EXPECT_EQ(bootloader.firmware_version(factory), (FirmwareVersion{1110, 1, 42}));
    EXPECT_EQ(value_of(Command::BOOT_READ_MEMORY, 0, Flash::start + 4) & 0xFFU, bytes[4]);
  }
}

TEST_F(SimBootloader, AFirmwareThatIsForAnotherModelSaysNothing) {
  upload(test::firmware_bytes(100, "3110V142"));
  EXPECT_TRUE(bootloader.has_firmware());
  EXPECT_EQ(bootloader.firmware_version(factory), factory);
}

TEST_F(SimBootloader, WhatWasNotErasedIsNotOverwritten) {
  ask(Command::BOOT_ERASE_ALL);
  ask(Command::BOOT_WRITE_BUFFER, 0, 0, 0x0000FF0FU);
  ask(Command::BOOT_WRITE_PAGE, 0, 0, Flash::start);
  ask(Command::BOOT_WRITE_BUFFER, 0, 0, 0x000000FFU);
  ask(Command::BOOT_WRITE_PAGE, 0, 0, Flash::start);
  EXPECT_EQ(value_of(Command::BOOT_READ_MEMORY, 0, Flash::start), 0x0000000FU);
}

TEST_F(SimBootloader, ThePageBufferIsEmptyAfterAPage) {
  ask(Command::BOOT_ERASE_ALL);
  ask(Command::BOOT_WRITE_BUFFER, 1, 0, 5);
  ask(Command::BOOT_WRITE_PAGE, 0, 0, Flash::start);
  ask(Command::BOOT_WRITE_PAGE, 0, 0, Flash::start + Flash::page_size);
  EXPECT_EQ(value_of(Command::BOOT_READ_MEMORY, 0, Flash::start + 4), 5U);
  EXPECT_EQ(value_of(Command::BOOT_READ_MEMORY, 0, Flash::start + Flash::page_size + 4),
            0xFFFFFFFFU);
}

TEST_F(SimBootloader, NothingOutsideItsMemoryIsReachable) {
  for (const auto address : {0U, Flash::start - 1, Flash::size, 0xFFFFFFFFU}) {
    EXPECT_EQ(status_of(Command::BOOT_WRITE_PAGE, 0, 0, address), Status::invalid_value);
    EXPECT_EQ(status_of(Command::BOOT_GET_CHECKSUM, 0, 0, address), Status::invalid_value);
    EXPECT_EQ(status_of(Command::BOOT_READ_MEMORY, 0, 0, address), Status::invalid_value);
  }
  EXPECT_EQ(status_of(Command::BOOT_READ_MEMORY, 0, 0, Flash::start + 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::BOOT_WRITE_BUFFER, 128), Status::invalid_value);
  EXPECT_EQ(status_of(Command::BOOT_WRITE_BUFFER, 0, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::BOOT_WRITE_BUFFER, 255, 255), Status::invalid_value);
  EXPECT_EQ(status_of(Command::BOOT_WRITE_LENGTH, 2), Status::wrong_type);
}

TEST_F(SimBootloader, ALengthThatCannotBeIsNoFirmware) {
  for (const auto length : {0U, Flash::size, 0xFFFFFFFFU}) {
    ask(Command::BOOT_ERASE_ALL);
    ask(Command::BOOT_WRITE_LENGTH, 0, 0, length);
    ask(Command::BOOT_WRITE_LENGTH, 1, 0, 0);
    EXPECT_FALSE(bootloader.has_firmware()) << length;
  }
}

TEST_F(SimBootloader, EverythingElseIsAnInvalidCommand) {
  for (const auto& row : command_table()) {
    const auto number = static_cast<int>(row.command);
    const bool own = row.command == Command::GET_FIRMWARE_VERSION ||
                     row.command == Command::ENTER_BOOTLOADER || (number >= 200 && number <= 208);
    if (!own) {
      EXPECT_EQ(status_of(row.command), Status::invalid_command) << row.name;
    }
  }
}

TEST_F(SimBootloader, IsEnteredWithTheMagicNumbersOnly) {
  const Request right{ModuleAddress{1}, Command::ENTER_BOOTLOADER, 0x81, 0x92,
                      static_cast<std::int32_t>(0xA3B4C5D6)};
  EXPECT_EQ(check_bootloader_entry(right), Status::ok);
  auto wrong = right;
  wrong.type = 0;
  EXPECT_EQ(check_bootloader_entry(wrong), Status::wrong_type);
  wrong = right;
  wrong.motor = 0;
  EXPECT_EQ(check_bootloader_entry(wrong), Status::invalid_value);
  wrong = right;
  wrong.value = 1;
  EXPECT_EQ(check_bootloader_entry(wrong), Status::invalid_value);
}

/// A whole module, over the wire.
class SimModuleBootloader : public SimTest {
 protected:
  void enter() {
    EXPECT_EQ(ask(Command::ENTER_BOOTLOADER, 0x81, 0x92, static_cast<std::int32_t>(0xA3B4C5D6)),
              std::nullopt);
    pass(Module::boot_time);
  }
  void start() {
    EXPECT_EQ(ask(Command::BOOT_START_APPLICATION, 0, 0), std::nullopt);
    pass(Module::boot_time);
  }
  Bytes version_text() {
    const auto request = encode_serial(Request{ModuleAddress{1}, Command::GET_FIRMWARE_VERSION});
    return exchange(Bytes(request.begin(), request.end()));
  }
  /// 16 bytes of firmware.
  void write(std::string_view version) {
    const auto bytes = test::firmware_bytes(16, version);
    std::int32_t sum = 0;
    ask(Command::BOOT_ERASE_ALL, 0, 0);
    for (std::uint8_t i = 0; i < 4; ++i) {
      std::uint32_t word = 0;
      for (std::size_t byte = 4; byte-- > 0;) word = word << 8U | bytes[4U * i + byte];
      ask(Command::BOOT_WRITE_BUFFER, i, 0, static_cast<std::int32_t>(word));
    }
    for (const auto byte : bytes) sum += byte;
    ask(Command::BOOT_WRITE_PAGE, 0, 0, Flash::start);
    ask(Command::BOOT_WRITE_LENGTH, 0, 0, 16);
    ask(Command::BOOT_WRITE_LENGTH, 1, 0, sum);
  }
};

TEST_F(SimModuleBootloader, IsEnteredSilentlyAndLeftAgain) {
  add(1110);
  enter();
  EXPECT_EQ(version_text(), (Bytes{2, '1', '1', '1', '0', 'B', '1', '0', '1'}));
  EXPECT_EQ(status_of(Command::GAP, 1, 0), Status::invalid_command);
  EXPECT_EQ(status_of(Command::BOOT_GET_INFO, 0, 0), Status::ok);
  start();
  EXPECT_EQ(version_text(), (Bytes{2, '1', '1', '1', '0', 'V', '1', '1', '3'}));
  EXPECT_EQ(status_of(Command::GAP, 1, 0), Status::ok);
  EXPECT_EQ(status_of(Command::BOOT_GET_INFO, 0, 0), Status::invalid_command);
}

TEST_F(SimModuleBootloader, MotorsStandInIt) {
  const auto& module = add(1110);
  ask(Command::ROR, 0, 0, 1000);
  pass(std::chrono::seconds(2));
  EXPECT_NE(get(axis_parameter::actual_velocity), 0);
  enter();
  pass(std::chrono::seconds(1));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_velocity), 0);
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_position), 0);
}

TEST_F(SimModuleBootloader, NoProgramRunsInIt) {
  const auto& module = add(1110);
  ask(Command::START_DOWNLOAD, 0, 0);
  ask(Command::ROR, 0, 0, 1000);
  ask(Command::STOP, 0, 0);
  ask(Command::END_DOWNLOAD, 0, 0);
  ask(Command::SGP, 77, 0, 1);
  enter();
  pass(std::chrono::seconds(1));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_velocity), 0);
  start();
  pass(std::chrono::seconds(1));
  EXPECT_NE(module.axis(0).get(axis_parameter::actual_velocity), 0);
}

TEST_F(SimModuleBootloader, TellsTheVersionOfTheNewFirmware) {
  add(1110);
  enter();
  write("1110V142");
  start();
  EXPECT_EQ(version_text(), (Bytes{2, '1', '1', '1', '0', 'V', '1', '4', '2'}));
}

TEST_F(SimModuleBootloader, StaysInItWithoutAFirmware) {
  add(1110);
  enter();
  ask(Command::BOOT_ERASE_ALL, 0, 0);
  start();
  EXPECT_EQ(status_of(Command::BOOT_GET_INFO, 0, 0), Status::ok);
  write("1110V142");
  start();
  EXPECT_EQ(status_of(Command::GAP, 1, 0), Status::ok);
}

TEST_F(SimModuleBootloader, ASuppressedReplyIsGivenInIt) {
  add(1110);
  ask(Command::SGP, 255, 0, 1);
  enter();
  EXPECT_EQ(status_of(Command::BOOT_ERASE_ALL, 0, 0), Status::ok);
}

TEST_F(SimModuleBootloader, WithoutTheMagicNumbersTheFirmwareGoesOn) {
  add(1110);
  EXPECT_EQ(status_of(Command::ENTER_BOOTLOADER, 0x81, 0x92, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::GAP, 1, 0), Status::ok);
}

TEST_F(SimModuleBootloader, AnswersOnCanAsWell) {
  add(1110);
  enter();
  can.receive(encode_can(Request{ModuleAddress{1}, Command::BOOT_GET_INFO, 1}));
  const auto sent_frames = frames();
  ASSERT_EQ(sent_frames.size(), 1U);
  EXPECT_EQ(decode_can_reply(sent_frames[0])->value, static_cast<std::int32_t>(Flash::start));
}

}  // namespace
}  // namespace tmcl::sim
