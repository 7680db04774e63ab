/// New firmware for a module, through its bootloader, as scripts.
///
/// The steps, and how each fails:
///
///     who is it?         the image must be for this model; nothing is changed otherwise
///     stop its motors    the chip would go on turning without supervision
///     enter bootloader   (skipped if it is in there already, as after an upload that failed)
///     page size, start   the image must fit; otherwise the old firmware is started again
///     erase, write       from here on there is no firmware; whatever fails, the module stays in
///     compare the sum    its bootloader, and the same upload can simply be started again
///     length and sum     now the bootloader trusts the firmware
///     start              until it answers
///
/// The module is held meanwhile (Hold): before it is in its bootloader commands of others wait, and
/// once it is there they end with Errc::in_bootloader, stops too. On a serial bus no call gets a
/// turn while one exchange takes its time: erasing may take some seconds. What the commands mean is
/// from PyTrinamic's tmclfwupload and the older tools for the stepRocker.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "tmcl/firmware.hpp"
#include "tmcl/script.hpp"

namespace tmcl {

struct FirmwareProgress {
  std::string_view step;  ///< "erasing", "writing" ...
  std::size_t written = 0;
  std::size_t of = 0;  ///< Bytes.
};

struct FirmwareOptions {
  /// Take the image although it does not say that it is for this model. It must still fit.
  bool force = false;
  /// How long a module may take to appear in its bootloader, and to come back out of it.
  Duration restart_time = std::chrono::seconds(10);
  /// Asked before the motors are stopped, and for the last time before the firmware is erased: an
  /// error ends the upload there, and the firmware is as before.
  std::function<std::optional<Error>()> objection{};
  /// Told before each step, and after each page.
  std::function<void(const FirmwareProgress&)> progress{};
};

/// An image held against a module.
struct FirmwareMatch {
  std::uint16_t model = 0;                 ///< Of the module; 0 if it does not say.
  bool in_bootloader = false;              ///< Its bootloader answers, not its firmware.
  FirmwareVersion running;                 ///< Of whichever answers.
  std::vector<FirmwareVersion> offered;    ///< All that stand in the image.
  std::optional<FirmwareVersion> version;  ///< The one for this module, if there is one.
};

struct FirmwareReport {
  FirmwareMatch before;
  FirmwareVersion after;  ///< What the new firmware says of itself.
  std::uint32_t checksum = 0;
};

namespace verbs {

/// Only looks. Fails if the module does not answer.
Script<Result<FirmwareMatch>> match_firmware(ModuleAddress module, firmware::Image image);

/// Errors: Errc::bad_argument with nothing changed if the image does not belong to the module or
/// into its memory; any other, with a hint that says what state the module is in.
Script<Result<FirmwareReport>> upload_firmware(ModuleAddress module, firmware::Image image,
                                               FirmwareOptions options = {});

}  // namespace verbs
}  // namespace tmcl
