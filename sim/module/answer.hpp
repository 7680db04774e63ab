/// What a module answers to a command.
#pragma once

#include <cstdint>

#include <tl/expected.hpp>

#include "tmcl/datagram.hpp"
#include "tmcl/program.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

struct Answer {
  enum class Form : std::uint8_t {
    reply,
    version_text,  ///< Eight characters instead of status and value.
    program_line,  ///< A command of the stand-alone program instead of status and value.
    none,          ///< Suppressed by global parameter 255, or a command that has no reply.
  };
  Form form = Form::reply;
  Status status = Status::ok;
  std::int32_t value = 0;
  program::Instruction line{};
  bool operator==(const Answer&) const = default;
};

inline constexpr Answer no_answer{Answer::Form::none, Status::ok, 0};

/// Except for what a command reads, a reply's value repeats the request's.
inline Answer echo(const Request& request, Status status = Status::ok) {
  return {Answer::Form::reply, status, request.value};
}

/// An unknown number is answered with 0, not with the request's value, as the vendor's firmware
/// does.
inline Answer reading(const tl::expected<std::int32_t, Status>& result) {
  return {Answer::Form::reply, result ? Status::ok : result.error(), result.value_or(0)};
}

}  // namespace tmcl::sim
