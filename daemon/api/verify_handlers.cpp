#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "gateway/journey/verification.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

using boost::asio::awaitable;
using Travel = std::optional<tmcl::ValueRange>;

/// Both ends, or none.
Task<Travel> travel_of(GatewayAxis& axis, const axis::Verify& params) {
  using P = axis::Verify;
  const auto from = raw_or_quantity<&P::from_microsteps, &P::from>(params);
  const auto to = raw_or_quantity<&P::to_microsteps, &P::to>(params);
  const bool has_from = from.plain || from.amount;
  const bool has_to = to.plain || to.amount;
  if (!has_from && !has_to) co_return Travel{};
  if (has_from != has_to)
    co_return param_error("bad_argument", has_from ? "to" : "from", "'from' and 'to' go together");
  const auto least = co_await must(length_of(axis, from, nullptr));
  const auto greatest = co_await must(length_of(axis, to, nullptr));
  // An axis may count the other way round.
  const auto [low, high] = std::minmax(least.microsteps.value, greatest.microsteps.value);
  if (low <= 0 && high >= 0 && low < high) co_return Travel{{low, high}};
  co_return param_error("out_of_range", "from",
                        "the axis must be within its travel: 'from' is 0 or less, "
                        "'to' is 0 or more",
                        "both count from where it stands, such as -2mm..2mm");
}

axis::VerifiedTrait view_of(const tmcl::TraitFinding& finding) {
  const auto& info = tmcl::trait_table()[static_cast<std::size_t>(finding.trait)];
  axis::VerifiedTrait view{std::string(info.name),
                           std::string(info.variants[finding.expected]),
                           finding.measured,
                           {},
                           finding.text};
  for (const auto variant : finding.fits) view.fits.emplace_back(info.variants[variant]);
  return view;
}

axis::Verified view_of(const tmcl::Verification& found, const GatewayAxis& axis) {
  axis::Verified view;
  view.model = found.model->name;
  view.firmware = to_string(found.version);
  if (found.answer) view.answer_us = *found.answer / std::chrono::microseconds(1);
  for (const auto& finding : found.traits) view.traits.push_back(view_of(finding));
  for (const auto& move : found.moves) {
    view.moves.push_back({move.distance, move.settings, tmcl::seconds(move.foreseen),
                          tmcl::seconds(move.least), tmcl::seconds(move.most)});
  }
  view.report = report_of(found, "axis '" + axis.name() + "'");
  return view;
}

}  // namespace

Answer<axis::Verify> verify(Call& call, const axis::Verify& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  co_await must(axis->be_ready(), *axis);
  const auto travel = co_await must(travel_of(*axis, params));
  if (!travel && !axis->soft_limits()) {
    co_return param_error("bad_argument", "from", "axis '" + axis->name() + "' has no soft limits",
                          "say how far it may go from where it stands, such as --travel -2mm..2mm");
  }
  VerificationRequest request{travel, call.peer->client(), call.permit, {}};
  request.tell = [reporter = call.progress_reporter(),
                  name = axis->name()](const std::string& what) {
    reporter(axis::VerifyProgress{name, what});
  };
  const auto found = co_await must(verify_axis(call.gateway, axis, std::move(request)), *axis);
  co_return view_of(found, *axis);
}

}  // namespace tmcld::handlers
