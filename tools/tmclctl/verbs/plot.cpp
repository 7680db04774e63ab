// plot.
#include "verbs.hpp"

namespace tmclctl {
VerbResult run(const verb::Plot&, Room&) { return ExitCode::done; }
}  // namespace tmclctl
