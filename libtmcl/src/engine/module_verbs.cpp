#include "tmcl/module_verbs.hpp"

#include <array>

#include "engine/verb_steps.hpp"

namespace tmcl::verbs {
namespace {

// What keeps a garbled datagram from restarting a module.
constexpr std::int32_t really = 1234;

struct Question {
  std::uint8_t type;
  std::optional<std::int32_t> FirmwareInfo::*answer;
};
constexpr std::array questions{
    Question{0, &FirmwareInfo::module_id},
    Question{1, &FirmwareInfo::version},
    Question{2, &FirmwareInfo::capabilities},
    Question{3, &FirmwareInfo::release_type},
    Question{10, &FirmwareInfo::bootloader_id},
    Question{11, &FirmwareInfo::bootloader_version},
    Question{20, &FirmwareInfo::axis_parameter_width},
    Question{21, &FirmwareInfo::register_address_width},
    Question{30, &FirmwareInfo::git_hash},
};

}  // namespace

Script<Result<void>> store_global(ModuleAddress module, std::uint8_t bank, std::uint8_t parameter) {
  return act({module, Command::STGP, parameter, bank, 0});
}

Script<Result<void>> restore_global(ModuleAddress module, std::uint8_t bank,
                                    std::uint8_t parameter) {
  return act({module, Command::RSGP, parameter, bank, 0});
}

Script<Result<std::int32_t>> get_io(ModuleAddress module, IoBank bank, std::uint8_t port) {
  return ask({module, Command::GIO, port, static_cast<std::uint8_t>(bank), 0});
}

Script<Result<void>> set_output(ModuleAddress module, std::uint8_t port, std::int32_t value) {
  const auto bank = static_cast<std::uint8_t>(IoBank::digital_outputs);
  auto done = co_await act({module, Command::SIO, port, bank, value});
  if (done || done.error().outcome != Outcome::unknown) co_return done;
  const auto present = co_await get_io(module, IoBank::digital_outputs, port);
  if (present && *present == value) co_return Result<void>{};
  co_return done;
}

Script<Result<FirmwareInfo>> firmware_info(ModuleAddress module) {
  FirmwareInfo info;
  for (const auto& question : questions) {
    const Request request{module, Command::GET_INFO, question.type, 0, 0};
    info.*question.answer = co_await must(unless_refused(ask(request)));
  }
  co_return info;
}

Script<Result<void>> request_arrival_events(ModuleAddress module, ArrivalEvents events,
                                            std::int32_t motors) {
  return act({module, Command::TARGET_REACHED_EVENT, static_cast<std::uint8_t>(events), 0, motors});
}

Script<Result<void>> reset_module(ModuleAddress module) {
  return act({module, Command::SOFTWARE_RESET, 0, 0, really});
}

Script<Result<void>> factory_reset(ModuleAddress module) {
  return act({module, Command::FACTORY_RESET, 0, 0, really});
}

}  // namespace tmcl::verbs
