// Commands after which something else listens: the ASCII mode, the bootloader, or the firmware
// again.
#include "sim/module/command_groups.hpp"
#include "tmcl/ascii.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {

Answer SystemCommands::enter_ascii_mode(const Request& request) {
  if (!module_.has_letter()) return echo(request, Status::command_not_available);
  module_.in_ascii_mode = true;
  return echo(request);
}

// The motors stand still: whatever drives them begins anew.
Answer SystemCommands::enter_bootloader(const Request& request) {
  const auto status = check_bootloader_entry(request);
  if (status != Status::ok) return echo(request, module_.wrong_code(status));
  module_.bootloader_wanted = true;
  module_.restarts = true;
  return no_answer;
}

Answer SystemCommands::execute_in_bootloader(const Request& request) {
  module_.restarts = request.command == Command::BOOT_START_APPLICATION;
  return module_.bootloader.execute(request);
}

}  // namespace tmcl::sim
