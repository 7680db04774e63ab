// Everything that is said of modules as a whole.
#include "grammar.hpp"
#include "help_text.hpp"

namespace tmclctl {

void add_raw(Grammar& grammar) {
  auto raw = grammar.verb<verb::Raw>("raw", "Send one command as it is", help_text::raw);
  raw.option("--bus", "NAME", "Which of tmcld's buses; needed if there are several",
             text(raw->bus));
  raw.word("ADDRESS", "The module's address", number(raw->address, 0, greatest_address));
  raw.word("COMMAND", "Name such as GAP, or number", text(raw->command));
  raw.word("TYPE", "Name such as ABS or a parameter's, or number", text(raw->type));
  raw.word("MOTOR", "Motor or bank", number(raw->motor));
  raw.word("VALUE", "May be negative", number(raw->value));
}

void add_firmware(Grammar& grammar) {
  const auto firmware = grammar.group("firmware", "Firmware files, and new firmware for a module",
                                      help_text::firmware);
  auto info = grammar.verb<verb::FirmwareInfo>(firmware, "info", "What is in a firmware file",
                                               help_text::firmware_info);
  info.word("FILE", "An Intel HEX file", text(info->file));
  auto check = grammar.verb<verb::CheckFirmware>(
      firmware, "check", "Does a firmware file belong to a module?", help_text::firmware_check);
  check.word("FILE", "An Intel HEX file", text(check->file));
  check.word("MODULE", "The module's address", number(check->address, 0, greatest_address));
  auto upload = grammar.verb<verb::UploadFirmware>(
      firmware, "upload", "Exchange the firmware of a module", help_text::firmware_upload);
  upload.word("FILE", "An Intel HEX file", text(upload->file));
  upload.word("MODULE", "The module's address", number(upload->address, 0, greatest_address));
  upload.flag("--force", "Also a file that does not say that it is for this model", upload->force);
}

}  // namespace tmclctl
