#include "target.hpp"

#include <cstdlib>

#include "daemon_target.hpp"
#include "direct_target.hpp"

namespace tmclctl {
namespace {

std::string socket_path(const Where& where) {
  if (!where.socket.empty()) return where.socket;
  const char* wished = std::getenv("TMCLD_SOCKET");
  return wished != nullptr && *wished != '\0' ? wished : std::string(default_socket);
}

}  // namespace

Attempt<std::unique_ptr<Target>> open_target(const Where& where, Patience& patience) {
  if (!where.direct.empty()) return DirectTarget::open(where.direct, where.full_steps, patience);
  // What the environment says will hold for the user's next command, too.
  auto options = where.socket.empty() ? std::string{} : " --socket " + where.socket;
  return DaemonTarget::open(socket_path(where), std::move(options), patience);
}

namespace {

tl::unexpected<Failure> needs_own_bus() {
  return tl::unexpected(usage_failure(
      "needs_direct", "firmware goes over a bus that nobody else uses meanwhile, not through tmcld",
      "Stop tmcld and name the bus, as in 'tmclctl --direct serial:/dev/ttyACM0 firmware ...'"));
}

}  // namespace

Attempt<tmcl::FirmwareMatch> Target::match_firmware(tmcl::ModuleAddress,
                                                    const tmcl::firmware::Image&) {
  return needs_own_bus();
}

Attempt<tmcl::FirmwareReport> Target::upload_firmware(tmcl::ModuleAddress,
                                                      const tmcl::firmware::Image&,
                                                      const tmcl::FirmwareOptions&) {
  return needs_own_bus();
}

}  // namespace tmclctl
