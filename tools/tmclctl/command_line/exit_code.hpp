/// What tmclctl's exit codes mean; scripts rely on them.
#pragma once

#include "tmcl/client_error.hpp"

namespace tmclctl {

enum class ExitCode : int {
  done = 0,
  refused = 1,      ///< The module or the daemon said no, and nothing changed; or it was done, and
                    ///< what came of it could not be written.
  usage = 2,        ///< The command line asks for what does not exist or is out of range, or a file
                    ///< that it names is wrong; nothing was sent.
  not_sent = 3,     ///< No module was reached, or one that was only asked did not answer; nothing
                    ///< changed.
  unknown = 4,      ///< Sent, but no answer: it may have been executed.
  not_reached = 5,  ///< Waiting ended early: the move was interrupted, or its time was up.
  interrupted = 130,
  terminated = 143,
};

ExitCode exit_code_of(const tmcl::client::Error& error);

}  // namespace tmclctl
