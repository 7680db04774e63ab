// Commands after which something else listens: the bootloader, or its firmware again.
#include "sim/module/module.hpp"

namespace tmcl::sim {

// The motors stand still: whatever drives them begins anew.
Answer Module::enter_bootloader(const Request& request) {
  const auto status = check_bootloader_entry(request);
  if (status != Status::ok) return echo(request, status);
  bootloader_wanted_ = true;
  restarts_ = true;
  return no_answer;
}

Answer Module::execute_in_bootloader(const Request& request) {
  restarts_ = request.command == Command::BOOT_START_APPLICATION;
  return bootloader_.execute(request);
}

}  // namespace tmcl::sim
