#include "gateway/module/settings_guard.hpp"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "async/spawn.hpp"
#include "gateway/gateway.hpp"
#include "gateway/module/module_settings.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using Differences = std::vector<tmcl::SettingDifference>;

/// Of a drift, so many are named.
constexpr std::size_t most_named = 3;

std::string in_words(const Differences& differences, const tmcl::Model& model) {
  std::string text;
  for (std::size_t i = 0; i < differences.size() && i < most_named; ++i)
    text += (text.empty() ? "" : ", ") + describe(differences[i], model);
  if (differences.size() <= most_named) return text;
  return text + fmt::format(", and {} more", differences.size() - most_named);
}

void report(const SettingsTask& task, std::string what, const char* reason) {
  task.bus->log(LogLevel::warning,
                fmt::format("{}: module {}: {}", task.bus->name(), number(task.address), what));
  GatewayEvent event{GatewayEvent::Kind::settings_drift, task.bus->name(), number(task.address)};
  event.text = std::move(what);
  event.reason = reason;
  task.bus->emit(event);
}

/// Sets them as they are in the file, and says what came of it.
awaitable<void> put_right(SettingsTask task, GatewayModule& module, Differences drift) {
  const auto& config = module.settings_config();
  const auto& model = *config.wanted->model;
  const auto what =
      fmt::format("its settings are not as in {}: {}", config.file, in_words(drift, model));
  const auto loaded = co_await load_settings(task, config.wanted);
  if (!loaded || loaded->objection) {
    const auto& error = loaded ? *loaded->objection : loaded.error();
    report(task, what + "; they cannot be set: " + error.message, "not_restored");
    co_return;
  }
  module.note_drift(loaded->differing);
  if (loaded->differing.empty()) {
    report(task, what + "; they are set again", "restored");
  } else {
    report(task, what + "; not all could be set: " + in_words(loaded->differing, model),
           "not_restored");
  }
}

/// False if the module does not answer.
awaitable<bool> compare(SettingsTask task) {
  auto& module = task.bus->add_module(task.address);
  const auto& config = module.settings_config();
  const auto drift = co_await compare_settings(task, config.wanted);
  if (!drift) {
    module.note(drift.error());
    if (drift.error().code != tmcl::Errc::bad_argument) co_return false;
    report(task, "its settings are not compared with " + config.file + ": " + drift.error().message,
           "report");
    co_return true;
  }
  module.note_drift(*drift);
  if (drift->empty()) co_return true;
  if (config.at_reset == SettingsConfig::Drift::restore) {
    co_await put_right(task, module, *drift);
    co_return true;
  }
  report(task,
         fmt::format("its settings are not as in {}: {}", config.file,
                     in_words(*drift, *config.wanted->model)),
         "report");
  co_return true;
}

/// Once more if the module has started again meanwhile.
awaitable<void> compare_while_needed(SettingsTask task) {
  auto& module = task.bus->add_module(task.address);
  bool answers = true;
  while (answers && module.begin_to_compare_settings()) {
    answers = co_await compare(task);
    module.end_comparing_settings(!answers);
  }
}

bool is_news(GatewayEvent::Kind kind) {
  return kind == GatewayEvent::Kind::module_answers || kind == GatewayEvent::Kind::module_reset ||
         kind == GatewayEvent::Kind::module_replaced;
}

void look(const std::shared_ptr<Gateway>& gateway, const GatewayEvent& event) {
  if (!is_news(event.kind) || !event.address) return;
  const auto address = tmcl::ModuleAddress{*event.address};
  for (const auto& bus : gateway->buses()) {
    auto* module = bus->name() == event.bus ? bus->find_module(address) : nullptr;
    if (module == nullptr || !module->settings_config().wanted) continue;
    spawn(bus->executor(), compare_while_needed({gateway, bus, address, gateway->admit(), true}));
  }
}

}  // namespace

void guard_settings(const std::shared_ptr<Gateway>& gateway) {
  gateway->on_event([weak = std::weak_ptr(gateway)](const GatewayEvent& event) {
    if (const auto self = weak.lock()) look(self, event);
  });
}

}  // namespace tmcld
