#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/travel.hpp"
#include "gateway/journey/verification.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

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
