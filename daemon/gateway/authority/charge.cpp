#include "gateway/authority/charge.hpp"

#include <optional>
#include <utility>
#include <variant>

namespace tmcld {
namespace {

/// The arrivals outlive the exchange.
void put_on(tmcl::step::Exchange& exchange, const Charge& charge) {
  auto& options = exchange.options;
  options.asker = charge.permit.client;
  const auto effect = effect_of(exchange.request.command, exchange.request.type);
  const bool ends_with_client = charge.permit.only_asks && !charge.has_acted &&
                                effect == tmcl::Effect::reads && !options.hold;
  if (!ends_with_client || options.objection) return;
  options.objection = [all = charge.arrivals.get(), client = charge.permit.client] {
    return all->waits(client) ? std::nullopt : std::optional(client_gone());
  };
}

}  // namespace

tmcl::Script<tmcl::Result<void>> charged(tmcl::Script<tmcl::Result<void>> script, Charge charge) {
  auto now = co_await tmcl::current_time();
  auto step = script.start(now);
  while (step) {
    tmcl::StepResult results;
    if (const auto* pause = std::get_if<tmcl::step::Pause>(&*step)) {
      co_await tmcl::pause(pause->duration);
    } else if (auto* one = std::get_if<tmcl::step::Exchange>(&*step)) {
      put_on(*one, charge);
      results.push_back(co_await tmcl::exchange(one->request, one->options));
    } else {
      auto& all = std::get<tmcl::step::ExchangeAll>(*step).exchanges;
      for (auto& each : all) put_on(each, charge);
      results = co_await tmcl::exchange_all(std::move(all));
    }
    now = co_await tmcl::current_time();
    step = script.resume(std::move(results), now);
  }
  co_return script.take();
}

}  // namespace tmcld
