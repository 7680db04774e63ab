#include "reconnecting_watch.hpp"

namespace tmclctl {
namespace {

constexpr auto look_interval = std::chrono::seconds(1);
// A watcher looks at keys and at the time in between.
constexpr auto shortest_sleep = std::chrono::milliseconds(100);

bool ends(const AxesWatcher& watcher, const Context& context) {
  return context.host.signal() != 0 || !watcher.wanted();
}

/// False when the watching has ended before tmcld came back.
bool await_return(const AxesWatcher& watcher, Context& context) {
  while (!ends(watcher, context)) {
    if (context.gateway.caller.reopen()) return true;
    const auto until = context.host.now() + look_interval;
    while (!ends(watcher, context) && context.host.now() < until) context.sleep(shortest_sleep);
  }
  return false;
}

}  // namespace

bool is_away(const Error& failure) {
  using namespace tmcl::client::error_name;
  return failure.name == lost || failure.name == unreachable || failure.name == timeout;
}

Result<void> keep_watching(const Watched& wanted, const AxesWatcher& watcher,
                           const std::function<void(const Error*)>& on_away, Context& context) {
  while (true) {
    const auto watched = watch_axes(wanted, watcher, context);
    // A signal ends a call, too, and that is how a watching ends.
    if (watched || context.host.signal() != 0) return {};
    if (!is_away(watched.error())) return watched;
    on_away(&watched.error());
    if (!await_return(watcher, context)) return {};
    on_away(nullptr);
  }
}

}  // namespace tmclctl
