/// A TMCM-3110 with firmware 1.09 and the simulator's bootloader, for a FakeModule to play.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "sim/module/bootloader.hpp"
#include "support/fake_module.hpp"
#include "tmcl/firmware.hpp"
#include "tmcl/version.hpp"

namespace tmcl::test {

class Bootable {
 public:
  /// The module must not outlive this.
  void be_played_by(FakeModule& module) {
    address_ = module.address();
    module.play = [this](const Request& request) { return play(request); };
    for (std::uint8_t motor = 0; motor < 3; ++motor)
      module.parameter(motor, axis_parameter::actual_velocity) = 0;
  }

  FirmwareVersion runs() const { return bootloader.firmware_version({}); }

  sim::Bootloader bootloader{3110, {3110, 1, 9}};
  bool in_bootloader = false;
  bool enters = true;
  bool starts = true;
  /// What the bootloader answers instead.
  std::function<std::optional<Status>(const Request&)> refuse;
  std::vector<Command> changes;  ///< Commands to the bootloader that change something.

 private:
  std::optional<Reply> play(const Request& request) {
    Reply reply{default_host_address, address_, Status::ok, request.command, request.value};
    if (!in_bootloader) return play_firmware(request, reply);
    if (const auto status = refuse ? refuse(request) : std::nullopt) {
      reply.status = *status;
      return reply;
    }
    if (effect_of(request.command, request.type) != Effect::reads)
      changes.push_back(request.command);
    const auto answer = bootloader.execute(request);
    if (request.command == Command::BOOT_START_APPLICATION)
      in_bootloader = !(starts && bootloader.has_firmware());
    reply.status = answer.status;
    reply.value = answer.value;
    return reply;
  }

  std::optional<Reply> play_firmware(const Request& request, Reply reply) {
    const auto number = static_cast<int>(request.command);
    if (request.command == Command::GET_FIRMWARE_VERSION) {
      reply.value = to_value(runs());
      return reply;
    }
    if (request.command == Command::ENTER_BOOTLOADER) {
      EXPECT_EQ(sim::check_bootloader_entry(request), Status::ok);
      in_bootloader = enters;
      return reply;
    }
    if (number < 200) return std::nullopt;
    reply.status = Status::invalid_command;
    return reply;
  }

  std::uint8_t address_ = 0;
};

}  // namespace tmcl::test
