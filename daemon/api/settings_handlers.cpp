// The settings of modules, and files of them.
#include "api/settings_handlers.hpp"

#include "api/journey.hpp"
#include "api/lookup.hpp"
#include "api/module_choice.hpp"
#include "config/settings_file.hpp"
#include "gateway/module/module_settings.hpp"

namespace tmcld::handlers {
namespace {

using SettingInfos = std::vector<tmcl::SettingInfo>;
using Wanted = std::shared_ptr<const tmcl::Settings>;

SettingsTask task_for(const Call& call, const ModuleChoice& module) {
  SettingsTask task{call.gateway, module.bus, module.address, call.permit};
  task.tell = [reporter = call.progress_reporter()](const std::string& what) {
    reporter(settings::Progress{what});
  };
  return task;
}

/// Every problem of the text, and the first in words.
Error error_of(const tmcl::TextProblems& problems) {
  const auto& first = problems.front();
  auto error = param_error<&settings::Load::toml>(
      "bad_settings", "line " + std::to_string(first.line) + ": " + first.message);
  add_problems(error, problems);
  return error;
}

Result<Wanted> wanted_in(const std::string& toml) {
  auto read = parse_settings(toml);
  if (!read) return tl::unexpected(error_of(read.error()));
  return std::make_shared<const tmcl::Settings>(*std::move(read));
}

/// That of the configuration without one.
Result<Wanted> wanted_of(const std::optional<std::string>& toml, const ModuleChoice& module) {
  if (toml) return wanted_in(*toml);
  const auto* known = module.bus->find_module(module.address);
  const auto wanted = known == nullptr ? nullptr : known->settings_config().wanted;
  if (wanted) return wanted;
  return tl::unexpected(param_error<&settings::Compare::toml>(
      "bad_argument", "no file of settings is configured for this module",
      "give one, or name it in [[module]] as 'settings'"));
}

// ---- views

template <class View>
View view_of(const tmcl::SettingKey& key, const SettingInfos& infos) {
  View view;
  view.section = section_of(key);
  view.number = key.number;
  if (const auto* info = find_setting(infos, key)) view.parameter = info->name;
  return view;
}

std::vector<settings::Setting> view_of(const std::vector<tmcl::SettingValue>& values,
                                       const SettingInfos& infos, const tmcl::Settings& of) {
  std::vector<settings::Setting> views;
  for (const auto& [key, value] : values) {
    auto view = view_of<settings::Setting>(key, infos);
    view.value = value;
    if (const auto* info = find_setting(infos, key)) {
      view.initial = info->initial;
      view.meaning = info->meaning;
      if (const auto unit = unit_of(*info, of); !unit.empty()) view.unit = std::string(unit);
    }
    views.push_back(std::move(view));
  }
  return views;
}

std::vector<settings::Difference> view_of(const std::vector<tmcl::SettingDifference>& differences,
                                          const SettingInfos& infos) {
  std::vector<settings::Difference> views;
  for (const auto& difference : differences) {
    auto view = view_of<settings::Difference>(difference.key, infos);
    view.present = difference.present;
    view.wanted = difference.wanted;
    views.push_back(std::move(view));
  }
  return views;
}

std::vector<settings::Refused> view_of(const std::vector<RefusedSetting>& refused,
                                       const SettingInfos& infos) {
  std::vector<settings::Refused> views;
  for (const auto& [setting, error] : refused) {
    auto view = view_of<settings::Refused>(setting.key, infos);
    view.why = error.message;
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace

Answer<settings::Read> read_all_settings(Call& call, const settings::Read& params) {
  const auto module = co_await must(module_of(call, params));
  const auto read = co_await must(read_settings(task_for(call, module)));
  const auto& model = *read.model;
  co_return settings::Settings{std::string(model.name), read.firmware,
                               view_of(read.values, settings_of(model), read),
                               view_of(read.apart, kept_apart(model), read), to_toml(read)};
}

Answer<settings::Compare> compare_with_file(Call& call, const settings::Compare& params) {
  const auto module = co_await must(module_of(call, params));
  const auto wanted = co_await must(wanted_of(params.toml, module));
  const auto found = co_await must(compare_settings(task_for(call, module), wanted));
  co_return settings::Differences{std::string(wanted->model->name),
                                  view_of(found, settings_of(*wanted->model))};
}

Answer<settings::Load> load_file(Call& call, const settings::Load& params) {
  const auto module = co_await must(module_of(call, params));
  const auto wanted = co_await must(wanted_in(params.toml));
  const auto task = task_for(call, module);
  const auto loaded = co_await must(load_settings(task, wanted));
  if (const auto& objection = loaded.objection)
    co_return not_now("moving", objection->message, objection->hint);
  const auto infos = settings_of(*wanted->model);
  settings::Loaded result{view_of(loaded.written, infos), view_of(loaded.refused, infos),
                          view_of(loaded.differing, infos)};
  if (!params.store.value_or(false)) co_return result;
  const auto kept = co_await must(store_settings(task, keys_of(wanted->values)));
  result.stored = static_cast<std::int32_t>(kept.stored);
  for (auto& refused : view_of(kept.refused, infos)) result.refused.push_back(std::move(refused));
  co_return result;
}

Answer<settings::Store> store_axis(Call& call, const settings::Store& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  co_await must(axis->be_ready(), *axis);
  const auto* model = axis->module().model();
  if (model == nullptr) {
    co_return param_error<&settings::Store::axis>(
        "unknown_model",
        "the model of axis " + axis->name() + " is not known, so its settings are not, either");
  }
  const auto infos = settings_of(*model);
  std::vector<tmcl::SettingKey> keys;
  for (const auto& info : infos) {
    const bool is_its_own =
        info.key.scope == tmcl::SettingScope::motor && info.key.motor == axis->address().motor;
    if (is_its_own) keys.push_back(info.key);
  }
  const ModuleChoice module{axis->bus().shared_from_this(), axis->address().module};
  const auto kept = co_await must(store_settings(task_for(call, module), std::move(keys)));
  co_return settings::Stored{axis->name(), static_cast<std::int32_t>(kept.stored),
                             view_of(kept.refused, infos)};
}

}  // namespace tmcld::handlers
