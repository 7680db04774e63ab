/// Whose the commands of a verb are, as the queue of a bus counts them.
#pragma once

#include <memory>

#include "gateway/authority/judge.hpp"
#include "gateway/authority/motors.hpp"
#include "tmcl/error.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

/// Who is asked for, and until when.
struct Charge {
  Permit permit;
  const bool& has_acted;  ///< Of the verb: it is carried out to its end then.
  std::shared_ptr<const Arrivals> arrivals;
};

/// Charges the client with all that goes out for its verb: also with what is asked about others
/// before a request is let out. What only asks ends when its client goes.
tmcl::Script<tmcl::Result<void>> charged(tmcl::Script<tmcl::Result<void>> script, Charge charge);

}  // namespace tmcld
