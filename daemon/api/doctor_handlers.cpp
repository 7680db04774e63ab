// What keeps axes from moving.
#include "api/doctor_handlers.hpp"

#include <utility>

#include "api/lookup.hpp"
#include "gateway/examination.hpp"

namespace tmcld::handlers {
namespace {

Result<Examined> examined_by(const Call& call, const doctor::Examine& params) {
  Examined what;
  what.client = call.permit.client;
  if (params.axis && params.bus)
    return tl::unexpected(param_error<&doctor::Examine::bus>(
        "bad_argument", "give 'axis' or 'bus', not both", "an axis has its bus with it"));
  if (params.axis) {
    auto axis = axis_of(call, *params.axis);
    if (!axis) return tl::unexpected(std::move(axis.error()));
    what.buses.push_back((*axis)->bus().shared_from_this());
    what.axes.push_back(*std::move(axis));
    return what;
  }
  if (params.bus) {
    auto bus = bus_of(call, *params.bus);
    if (!bus) return tl::unexpected(std::move(bus.error()));
    what.buses.push_back(*std::move(bus));
  } else {
    what.buses.assign(call.gateway->buses().begin(), call.gateway->buses().end());
  }
  for (const auto& axis : call.gateway->axes())
    for (const auto& bus : what.buses)
      if (&axis->bus() == bus.get()) what.axes.push_back(axis);
  return what;
}

doctor::Finding view_of(const tmcl::Finding& finding) {
  doctor::Finding view{
      std::string(info_of(finding.check).name), finding.subject, finding.wrong, finding.text, {}};
  if (finding.wrong) view.cure = cure_of(finding);
  return view;
}

}  // namespace

Answer<doctor::Examine> examine(Call& call, const doctor::Examine& params) {
  auto what = co_await must(examined_by(call, params));
  const auto findings = co_await tmcld::examine(call.gateway, std::move(what));
  doctor::Findings result;
  for (const auto& finding : findings) result.findings.push_back(view_of(finding));
  co_return result;
}

}  // namespace tmcld::handlers
