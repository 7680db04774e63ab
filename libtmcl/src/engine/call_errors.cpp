#include "engine/call_errors.hpp"

#include <fmt/format.h>

namespace tmcl::engine {
namespace {

Error error_for(const Call& call, Errc code, std::string message, std::string hint = {}) {
  const auto outcome =
      call.times_sent == 0 && !call.sent_early ? Outcome::not_sent : Outcome::unknown;
  return {code, outcome, std::move(message), std::move(hint), {}, call.request, {}};
}

std::int64_t in_milliseconds(Duration duration) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
}

}  // namespace

Error bad_address(ModuleAddress address, unsigned highest) {
  return bad_argument(fmt::format("{} is no module address", number(address)),
                      fmt::format("addresses on this bus are 0 to {}", highest));
}

Error queue_overflow(const Call& call) {
  return error_for(call, Errc::queue_full, "too many commands wait for this bus",
                   "send fewer commands at once, or use a faster bus");
}

Error deadline_error(const Call& call) {
  return error_for(call, Errc::deadline_passed,
                   "the deadline passed while the command was waiting");
}

Error superseded_error(const Call& call) {
  return error_for(call, Errc::superseded_by_stop, "a stop came first");
}

Error link_lost_error(const Call& call, const std::string& why) {
  return error_for(call, Errc::link_lost, why, "check the cable and the module's power");
}

Error silence_error(const Call& call) {
  return error_for(call, Errc::module_silent,
                   fmt::format("module {} does not answer", number(call.request.address)),
                   "check its power and address; 'tmclctl scan' shows who answers");
}

Error timeout_error(const Call& call, Duration waited) {
  const auto times =
      call.times_sent == 1 ? std::string("once") : fmt::format("{} times", call.times_sent);
  return error_for(call, Errc::reply_timeout,
                   fmt::format("no answer within {} ms, asked {}", in_milliseconds(waited), times),
                   "check address, baud rate and power; 'tmclctl scan' shows who answers");
}

Error full_link_error(const Call& call, Framing framing, Duration waited) {
  if (framing == Framing::can) {
    return error_for(
        call, Errc::queue_full,
        fmt::format("the interface's transmit queue was full for {} ms", in_milliseconds(waited)),
        "is another node on the bus, and the bit rate right? A greater txqueuelen takes more");
  }
  return error_for(call, Errc::queue_full,
                   fmt::format("the link took nothing for {} ms: what was written before is stuck",
                               in_milliseconds(waited)),
                   "is the adapter or the converter still alive, and does anything hold the line?");
}

Error doubt_error(const Call& call) {
  return error_for(
      call, Errc::unexpected_value,
      fmt::format("more than one reply came to it, {} times: which is meant cannot be told "
                  "right",
                  call.doubts),
      fmt::format("two modules have the address {}, or another program asks on this "
                  "bus: end that, or give one module another address",
                  number(call.request.address)));
}

Error surplus_error(const Call& call) {
  return error_for(call, Errc::unexpected_value,
                   fmt::format("module {} gives more replies than it is asked for, all the time: "
                               "which answers what cannot be told",
                               number(call.request.address)),
                   fmt::format("two modules have the address {}, or the link doubles replies: give "
                               "one module another address",
                               number(call.request.address)));
}

Error unsettled_error(const Call& call) {
  return error_for(
      call, Errc::unexpected_value,
      fmt::format("it was another value each of {} times that it was read, and not as if it moved",
                  call.readings),
      "the line loses, delays or doubles replies: see 'surplus' and 'late_replies' of bus.list");
}

Error ended_hold_error(const Call& call, Custody::End why) {
  if (why == Custody::End::stop)
    return error_for(call, Errc::superseded_by_stop, "a stop came and ended the download");
  return error_for(call, Errc::deadline_passed, "the module was held without being used");
}

Error no_download_error(const Call& call) {
  return error_for(call, Errc::download_broken, "the module is not in download mode");
}

Error broken_download_error(const Call& call) {
  return error_for(call, Errc::download_broken, "what the module recorded cannot be told any more");
}

Error recorded_error(const Call& call, Status status) {
  auto error = refusal(call.request, status);
  error.message = "the module is in download mode: it recorded the command instead of executing it";
  error.hint = "END_DOWNLOAD ends that; so does a stop, and loading a program anew";
  return error;
}

Error bootloader_error(const Call& call) {
  return error_for(call, Errc::in_bootloader,
                   fmt::format("module {} is in its bootloader and gets new firmware: it can "
                               "neither start nor stop a motor",
                               number(call.request.address)),
                   "wait until that has ended");
}

}  // namespace tmcl::engine
