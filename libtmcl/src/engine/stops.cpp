// What a stop makes pointless: movements that wait, and downloads to its module.
#include "engine/bus_engine.hpp"
#include "engine/call_errors.hpp"

namespace tmcl::engine {

void BusEngine::drop_moves_before(const Request& stop) {
  fail_if([&](const Call& queued) { return is_ended_by(stop, queued); }, superseded_error);
  end_downloads_for(stop);
}

/// On a serial line a stop for a module that was never heard may reach another: a module on USB
/// takes what is for any address.
void BusEngine::end_downloads_for(const Request& stop) {
  const bool reaches_others =
      modules_.framing() == Framing::serial && !modules_.with(stop.address).lane.was_heard();
  for (auto& [byte, module] : modules_.all()) {
    if (byte != reply_byte(stop.address) && !reaches_others) continue;
    const auto ended = module.custody.end_download();
    if (!ended) continue;
    fail_if([&](const Call& queued) { return queued.options.hold == ended; },
            [](const Call& call) { return ended_hold_error(call, Custody::End::stop); });
  }
}

}  // namespace tmcl::engine
