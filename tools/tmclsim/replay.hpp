/// Asks virtual modules what was recorded of others, and holds their replies against those.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "sim/bench.hpp"
#include "tmcl/trace_file.hpp"

namespace tmclsim {

struct ReplayReport {
  std::size_t requests = 0;
  std::size_t equal = 0;          ///< Replies that are those of the record, byte for byte.
  std::size_t other_values = 0;   ///< Replies that tell another value, and nothing else.
  std::size_t other_replies = 0;  ///< Replies that differ in more.
  std::size_t missing = 0;        ///< Replies of the record that virtual modules do not give.
  std::size_t surplus = 0;        ///< Replies of virtual modules that the record does not have.

  bool all_equal() const { return other_values + other_replies + missing + surplus == 0; }
};

/// Requests come in virtual time, as far apart as in the record: an hour takes seconds. Datagrams
/// on CAN and on serial lines each go to a wire of their kind. `tell` gets a line for each
/// difference. `bench` goes by `clock`.
ReplayReport replay(const tmcl::Trace& trace, tmcl::sim::Bench& bench, tmcl::VirtualClock& clock,
                    const std::function<void(const std::string&)>& tell);

/// "120 requests: 119 replies as recorded, 1 with another value", for people.
std::string describe(const ReplayReport& report);

}  // namespace tmclsim
