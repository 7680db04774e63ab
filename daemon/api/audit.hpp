/// Lines about what clients move and set: see log/audit.hpp.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "api/call.hpp"

namespace tmcld {

/// What is asked for, in so many words: "method=axis.stop params={...}", the axes first. Long texts
/// are cut, each for itself, so that none hides another; the proof of a lease is left out.
std::string words_of(std::string_view method, const boost::json::object& params);
/// A line or a path, which the gateway leads to its end: it needs no lease, and a line says that it
/// begins.
void begin_journey(Call& call);
/// What came of a call, if it has moved or set something, or was to.
void audit_end(const Call& call, const Result<boost::json::object>& result);
/// What became of a journey that outlives its call; `fault`: empty if nothing was wrong.
std::function<void(std::string_view fault)> audit_of_end(const Call& call);

}  // namespace tmcld
