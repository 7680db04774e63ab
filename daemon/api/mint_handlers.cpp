// Mint programs, run by the daemon.
#include <map>
#include <set>
#include <utility>

#include <boost/asio/this_coro.hpp>

#include "api/audit.hpp"
#include "api/handlers.hpp"
#include "api/journey.hpp"
#include "gateway/journey/mint_run.hpp"
#include "tmcl/plan/mint_preparation.hpp"
#include "tmcl/scale_factor.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

namespace plan = tmcl::plan;
using boost::asio::awaitable;
using tmcl::seconds;

struct ChosenProgram {
  std::vector<unsigned> numbers;  ///< In the program.
  std::vector<DriveMember> members;
};

Error wrong_numbers() {
  return param_error("bad_argument", "numbers",
                     "there must be one number from 0 to " +
                         std::to_string(plan::mint::most_axes - 1) +
                         " for each of 'axes', and each axis and each number once");
}

/// Those of "axes" that the program moves, in the order of their numbers.
Result<ChosenProgram> chosen(const Call& call, const mint::Run& params,
                             const std::set<unsigned>& moved) {
  const auto axes = axes_of(call, params.axes);
  if (!axes) return tl::unexpected(axes.error());
  const auto count = params.axes.size();
  if (axes->size() != count || (params.numbers && params.numbers->size() != count))
    return tl::unexpected(wrong_numbers());
  std::map<unsigned, std::shared_ptr<GatewayAxis>> by_number;
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = params.numbers ? (*params.numbers)[i] : i;
    if (number >= plan::mint::most_axes ||
        !by_number.emplace(static_cast<unsigned>(number), (*axes)[i]).second)
      return tl::unexpected(wrong_numbers());
  }
  ChosenProgram found;
  for (const auto number : moved) {
    const auto axis = by_number.find(number);
    if (axis == by_number.end()) continue;  // what moves it has a line
    found.numbers.push_back(number);
    auto movement = axis->second->begin_movement(call.permit, {});
    found.members.push_back({axis->second, std::move(movement)});
  }
  return found;
}

Result<bool> counts_encoder(const mint::Run& params) {
  const auto said = params.counts.value_or("microsteps");
  if (said == "encoder" || said == "microsteps") return said == "encoder";
  return tl::unexpected(
      param_error("bad_argument", "counts", "'counts' must be 'microsteps' or 'encoder'"));
}

/// What the configuration says of its encoder, and its module of its microsteps.
Result<double> microsteps_per_count(const GatewayAxis& axis,
                                    const std::optional<tmcl::UserScale>& scale) {
  const auto& counts = axis.encoder_counts_per_unit();
  if (counts && scale) return tmcl::microsteps_per_unit(*scale) / *counts;
  return tl::unexpected(
      param_error("unknown_units", "counts",
                  "what a count of the encoder of " + axis.name() + " is, is not known",
                  "the configuration says it: 'encoder_lines' or "
                  "'encoder_counts_per_unit'"));
}

Task<plan::MintAxis> known_axis(unsigned number, GatewayAxis& axis, bool counts_encoder) {
  const auto reading = co_await must(axis.read_state(), axis);
  if (reading.state.velocity.value != 0) {
    if (axis.claim_kind() != ClaimKind::none)
      co_await refuse(call_error(axis.claimed(), axis.name()));
    co_return param_error("moving", "axes", axis.name() + " is moving");
  }
  plan::MintAxis known{number, {axis.name(), axis.module().model()}, reading.state.position};
  known.units.module = co_await must(axis.module_units(), axis);
  known.units.scale = co_await must(axis.scale(), axis);
  if (counts_encoder) {
    const auto per_count = co_await must(microsteps_per_count(axis, known.units.scale));
    known.microsteps_per_count = per_count;
    known.counts_encoder = true;
  }
  known.units.limits = axis.soft_limits();
  co_return known;
}

mint::Ran view_of(const MintRun& run) {
  mint::Ran ran;
  for (std::size_t i = 0; i < run.report().took.size(); ++i) {
    const auto& group = run.groups()[i];
    ran.groups.push_back(
        {static_cast<std::int32_t>(group.line), group.duration, seconds(run.report().took[i])});
  }
  ran.remarks = remarks_of(run);
  if (!run.journal_failure().empty()) ran.remarks.push_back(journal_warning(run.journal_failure()));
  return ran;
}

MintChecked checked(const ChosenProgram& chosen, const plan::MintPlan& plan) {
  MintChecked told{"checked", {}, plan.remarks};
  for (std::size_t i = 0; i < chosen.members.size(); ++i) {
    told.axes.push_back(
        {static_cast<std::uint8_t>(chosen.numbers[i]), chosen.members[i].axis->name()});
  }
  return told;
}

/// A group that stands is told once, the one that is under way each time.
MintRun::OnProgress mint_progress_to(const Call& call) {
  return [reporter = call.progress_reporter(), told = std::size_t{0}](const MintRun& run) mutable {
    const auto tell = [&](const char* phase, const plan::MintDriveGroup& group,
                          tmcl::Duration passed) {
      reporter(MintProgress{phase, group.line, seconds(passed), group.duration});
    };
    const auto& took = run.report().took;
    for (; told < took.size(); ++told) tell("stands", run.groups()[told], took[told]);
    if (told < run.groups().size()) tell("running", run.groups()[told], run.passed());
  };
}

}  // namespace

Answer<mint::Run> run_mint(Call& call, const mint::Run& params) {
  auto text = co_await must(text_of(call, params));
  auto place = co_await must(place_to_plan(call, text.size()));
  auto& planner = call.gateway->planner;
  auto turn = co_await planner.take_turn(call.peer->client().number);
  auto read = [text = std::move(text)] {
    return plan::read_mint(text).map([](plan::mint::Program program) {
      auto moved = plan::axes_moved_by(program);
      return std::pair(std::move(program), std::move(moved));
    });
  };
  auto program = co_await planner.plan(std::move(read));
  if (!program) co_return error_of(program.error(), "text");
  begin_journey(call);
  auto members = co_await must(chosen(call, params, program->second));

  const auto in_counts = co_await must(counts_encoder(params));
  std::vector<plan::MintAxis> axes;
  for (std::size_t i = 0; i < members.members.size(); ++i) {
    auto axis = co_await must(known_axis(members.numbers[i], *members.members[i].axis, in_counts));
    axes.push_back(std::move(axis));
  }
  auto plan_it = [program = std::move(program->first), axes = std::move(axes)]() mutable {
    const auto once = std::exchange(program, {});
    return plan::plan_mint(once, axes);
  };
  auto planned = co_await planner.plan(std::move(plan_it));
  if (!planned) co_return error_of(planned.error(), "text");
  turn.reset();
  place.reset();
  place = co_await must(place_for(call, planned->bytes()));
  co_await must_not(refusal_to_begin(call));

  if (members.members.empty()) {
    co_return param_error("bad_program", "text", "the program moves nothing");
  }
  call.progress_reporter()(checked(members, *planned));
  const auto executor = co_await boost::asio::this_coro::executor;
  const auto run = std::make_shared<MintRun>(executor, std::move(planned->groups),
                                             std::move(members.members), mint_progress_to(call));
  const auto failure = co_await MintRun::pass(run);
  co_await must_not(failure);
  auto ran = view_of(*run);
  if (run->report().fault) co_return error_of(*run, api::to_json(ran));
  co_return ran;
}

}  // namespace tmcld::handlers
