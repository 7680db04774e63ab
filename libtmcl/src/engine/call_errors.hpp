/// What a call is told that ends without an answer.
#pragma once

#include "engine/call_queue.hpp"
#include "engine/custody.hpp"
#include "tmcl/link.hpp"

namespace tmcl::engine {

Error bad_address(ModuleAddress address, unsigned highest);
Error queue_overflow(const Call& call);
Error deadline_error(const Call& call);
Error superseded_error(const Call& call);
Error link_lost_error(const Call& call, const std::string& why);
Error silence_error(const Call& call);
/// It waited for an answer for so long, each time.
Error timeout_error(const Call& call, Duration waited);
Error full_link_error(const Call& call, Framing framing, Duration waited);
/// More than one answer came, too often.
Error doubt_error(const Call& call);
/// What a motor is to move by was read several times, and no two readings fit together.
Error surplus_error(const Call& call);
Error unsettled_error(const Call& call);

/// The hold of the call has ended.
Error ended_hold_error(const Call& call, Custody::End why);
/// A line of a program for a module that does not record.
Error no_download_error(const Call& call);
/// It is unknown now what the module recorded.
Error broken_download_error(const Call& call);
/// The module recorded what was to be executed.
Error recorded_error(const Call& call, Status status);
/// Another call has the module in its bootloader.
Error bootloader_error(const Call& call);

}  // namespace tmcl::engine
