/// Why a gateway did not do what it was asked for: one form from the wire to the screen.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>

#include "tmcl/error.hpp"

namespace tmcl::client {

/// What an error asks of the caller.
enum class ErrorKind : std::uint8_t {
  bad_request,  ///< Ask for something else: this cannot be. Nothing was sent.
  not_now,      ///< It could be, but for the state or the configuration. Nothing changed.
  failed,       ///< The outcome says how far it came.
  ended_early,  ///< It had begun, and has not come to its end.
  interrupted,  ///< The caller itself ended it, by Options::cancelled.
};

struct Error {
  /// snake_case, and stable: `data.name` of docs/PROTOCOL.md, or one of those below.
  std::string name;
  ErrorKind kind = ErrorKind::failed;
  Outcome outcome = Outcome::not_sent;
  std::string message;  ///< What happened, in one sentence without a full stop.
  std::string hint{};   ///< What to try; may be empty.
  /// What it is about, as far as that is known: bus, axis, address, command, status, param ...
  boost::json::object subject{};
};

template <class T>
using Result = tl::expected<T, Error>;

namespace error_name {
constexpr std::string_view unreachable =
    "daemon_unreachable";  ///< No connection; nothing was asked.
constexpr std::string_view incompatible =
    "daemon_incompatible";  ///< Something else listens there, or a newer tmcld.
constexpr std::string_view lost = "daemon_lost";        ///< The connection broke.
constexpr std::string_view timeout = "daemon_timeout";  ///< No answer in time.
constexpr std::string_view cancelled = "cancelled";     ///< Options::cancelled said so.
/// The axis has arrived by its counter, and its driver was off.
constexpr std::string_view driver_fault = "driver_fault";
/// The same, and its encoder is too far from there.
constexpr std::string_view not_in_position = "not_in_position";
}  // namespace error_name

/// A request that cannot be met: `bad_request`, unless it could be but for the state or the
/// configuration of an axis.
ErrorKind kind_of_objection(std::string_view name);

/// Of JSON-RPC, as it stands in answers and in lists of what failed.
Error error_from_json(const boost::json::object& error);
/// The same back; the code of JSON-RPC is computed.
boost::json::object to_json(const Error& error);
/// What is null in `subject` stands in JSON, and in no error of a client.
Error without_nulls(Error error);
/// What the library says.
Error error_from(const tmcl::Error& error);

}  // namespace tmcl::client
