/// Watching that lasts, whatever becomes of tmcld meanwhile.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "verbs/verbs.hpp"

namespace tmclctl {

/// Whether tmcld is not there, or not there any more: it may come back.
bool is_away(const Error& failure);

/// Watches axes until the watcher wants no more or a signal comes; looks for a tmcld that is away
/// once a second. `on_away` is told why it is away, and null once it is there again.
/// Errors: those of watch_axes() that no waiting helps against.
Result<void> keep_watching(const Watched& wanted, const AxesWatcher& watcher,
                           const std::function<void(const Error*)>& on_away, Context& context);

}  // namespace tmclctl
