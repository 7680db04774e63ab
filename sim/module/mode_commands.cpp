// Commands after which something else listens: the ASCII mode, the bootloader, or the firmware
// again.
#include "sim/module/module.hpp"
#include "tmcl/ascii.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {

// Above Z there is no letter that could bring it back.
bool Module::has_letter() const {
  return ascii::letter_of(globals_.byte(global_parameter::serial_address)).has_value();
}

Answer Module::enter_ascii_mode(const Request& request) {
  if (!has_letter()) return echo(request, Status::command_not_available);
  in_ascii_mode_ = true;
  return echo(request);
}

// The motors stand still: whatever drives them begins anew.
Answer Module::enter_bootloader(const Request& request) {
  const auto status = check_bootloader_entry(request);
  if (status != Status::ok) return echo(request, wrong_code(status));
  bootloader_wanted_ = true;
  restarts_ = true;
  return no_answer;
}

Answer Module::execute_in_bootloader(const Request& request) {
  restarts_ = request.command == Command::BOOT_START_APPLICATION;
  return bootloader_.execute(request);
}

}  // namespace tmcl::sim
