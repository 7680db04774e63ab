/// What methods have in common that run a text on axes, and answer at its end.
#pragma once

#include <string>
#include <vector>

#include <boost/json/object.hpp>

#include "api/call.hpp"
#include "api/lookup.hpp"
#include "gateway/journey/awaited_run.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld {

/// The parameter "text", or what was staged, by "bytes".
Result<std::string> text_of(const Call& call, const std::optional<std::string>& text,
                            std::optional<std::uint32_t> bytes);
template <class Params>
Result<std::string> text_of(const Call& call, const Params& params) {
  return text_of(call, params.text, params.bytes);
}

/// Room for planning what a text of so many bytes says. Error: queue_full.
Result<PlanningBudget::Place> place_to_plan(const Call& call, std::size_t text_bytes);
/// The same for so many bytes of what has been planned.
Result<PlanningBudget::Place> place_for(const Call& call, std::size_t bytes);

/// All that is wrong with a text, as the member "problems".
void add_problems(Error& error, const tmcl::TextProblems& problems);
/// `param` is where the client gave what is wrong.
Error error_of(const tmcl::plan::PathObjection& objection, std::string_view param);
/// Nothing new begins while the daemon ends.
std::optional<Error> refusal_to_begin(const Call& call);

/// Those that could not be stopped, and may still move.
constexpr const char* stop_them =
    "tmcld stops them until their modules say that they stand, which the event axis_stopped tells; "
    "if they must not move until then, cut their power";
/// Of axes that were to be stopped.
void add_outcome(Error& error, const std::vector<std::string>& unstopped);
/// Why it did not come to its end; `report` is what it would have answered.
Error error_of(const AwaitedRun& run, boost::json::object report);
/// What else is to be said, such as of a parameter not set back.
std::vector<std::string> remarks_of(const AwaitedRun& run);

}  // namespace tmcld
