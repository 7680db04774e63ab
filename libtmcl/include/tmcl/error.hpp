/// Errors are values with a cause that a person can act on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "tmcl/datagram.hpp"

namespace tmcl {

/// What is known about a command. Programs that move motors must branch on this.
enum class Outcome : std::uint8_t {
  done,      ///< Executed; the module said so (or the command sends no reply and is on the wire).
  refused,   ///< Not executed; the module said why.
  not_sent,  ///< Not executed; it never left this host.
  unknown,  ///< May have been executed. Repeated by the library only where the command's row allows
            ///< it.
};

enum class Errc : std::uint8_t {
  refused_by_module,   ///< The module answered with an error status.
  reply_timeout,       ///< No usable answer in time.
  module_silent,       ///< The module did not answer lately and was not asked again.
  superseded_by_stop,  ///< A stop came first; the command was dropped from the queue.
  deadline_passed,     ///< The caller's deadline passed while the command was waiting for its turn.
  queue_full,          ///< Too many commands wait for this bus, or its link takes nothing.
  link_lost,           ///< The link broke or was closed.
  link_open_failed,    ///< The link could not be opened.
  link_busy,           ///< Another program uses the link.
  bad_argument,        ///< The caller asked for something that cannot be; nothing was sent.
  move_interrupted,   ///< The axis stands, or is about to stand, somewhere else than where the move
                      ///< was to end.
  unexpected_value,   ///< Not the value that was set, or one of several that differ.
  download_broken,    ///< A program could not be loaded; the module is left without one that could
                      ///< run.
  beyond_soft_limit,  ///< The axis was to go where its soft limits do not let it; nothing was sent.
  in_bootloader,      ///< No firmware runs in the module: an upload is under way, or was broken
                      ///< off. It executes nothing meanwhile.
  axis_claimed,       ///< Another call moves the axis, along a line for instance; nothing was sent.
  daemon_ending,      ///< The daemon is ending, and nothing is set in motion any more.
  leased,             ///< Another client has a lease of the axis; nothing was sent.
  lease_lost,         ///< The lease that the call is made under has ended; nothing was sent.
  latched,        ///< The module has restarted or was replaced, and the axis is not cleared yet.
  not_permitted,  ///< Who asks for it may not have it, by the configuration; nothing was sent.
  stale_request,  ///< It was asked for before the daemon stood still for a while; nothing was sent.
  // Of quantities (tmcl/quantity.hpp); nothing was sent.
  bad_quantity,   ///< No number with a unit, or a fraction of what is counted.
  decimal_comma,  ///< The number has a comma.
  not_finite,     ///< Not a finite number.
  two_units,      ///< More than one number and one unit.
  bare_number,    ///< Without a unit, where the axis has one.
  unknown_unit,   ///< The axis has no such unit, or what it is worth is not known.
  wrong_unit,     ///< It measures something else.
  out_of_range,   ///< Not within what is possible.
};

struct Error {
  Errc code{};
  Outcome outcome = Outcome::not_sent;
  std::string message;             ///< What happened, in one sentence without a full stop.
  std::string hint;                ///< What to try; may be empty.
  std::string bus;                 ///< Name of the link or the configured bus; may be empty.
  std::optional<Request> request;  ///< The command it is about.
  std::optional<Status> status;    ///< What the module said, where it said something.
  std::string axis{};              ///< Name of the configured axis; may be empty.
};

template <class T>
using Result = tl::expected<T, Error>;

/// snake_case; part of the stable interface.
std::string_view name_of(Outcome outcome);
std::string_view name_of(Errc code);

/// "MVP ABS 51200 for motor 0 of module 1"
std::string describe(const Request& request);
/// Message, bus and command in one line; with the hint in a second one if there is a hint.
std::string describe(const Error& error);

/// The error for an answer with a status below 100.
Error refusal(const Request& request, Status status);
/// An error about what was not sent.
Error not_sent(Errc code, std::string message, std::string hint = {});
/// The same about something the caller passed in.
Error bad_argument(std::string message, std::string hint = {});

}  // namespace tmcl
