#include "gateway/module/module_settings.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "gateway/gateway.hpp"
#include "tmcl/program_verbs.hpp"
#include "tmcl/settings_verbs.hpp"

namespace tmcld {
namespace {

using tmcl::SettingDifference;
using tmcl::SettingKey;
using tmcl::Settings;
using tmcl::SettingScope;
using tmcl::SettingValue;
using Axes = std::vector<std::shared_ptr<GatewayAxis>>;

tl::unexpected<tmcl::Error> impossible(std::string message, std::string hint = {}) {
  return tl::unexpected(tmcl::bad_argument(std::move(message), std::move(hint)));
}

GatewayModule& module_of(const SettingsTask& task) { return task.bus->add_module(task.address); }

std::string name_of(const SettingsTask& task) {
  return fmt::format("module {} of bus '{}'", number(task.address), task.bus->name());
}

template <class T>
SettingsAnswer<T> run(const SettingsTask& task, tmcl::Script<tmcl::Result<T>> script) {
  RunOptions options;
  options.permit = task.by_itself ? Permit{} : task.permit;
  auto result = co_await task.bus->run(std::move(script), std::move(options));
  if (!result && result.error().bus.empty()) result.error().bus = task.bus->name();
  co_return result;
}

SettingsAnswer<const tmcl::Model*> known_model(const SettingsTask& task) {
  auto ready = co_await module_of(task).be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  const auto* model = module_of(task).model();
  if (model == nullptr)
    co_return impossible(
        name_of(task) + " is of no model that is known by name, so its settings are not",
        "'tmclctl models' lists those that are");
  co_return model;
}

SettingsAnswer<std::vector<SettingValue>> read_values(const SettingsTask& task,
                                                      std::vector<SettingKey> keys) {
  auto script = tmcl::verbs::read_settings(task.address, std::move(keys),
                                           [tell = task.tell](std::size_t done, std::size_t of) {
                                             tell(fmt::format("{} of {} settings read", done, of));
                                           });
  return run(task, std::move(script));
}

/// What the module has of what is wanted.
SettingsAnswer<Settings> read_present(const SettingsTask& task, const Settings& wanted) {
  const auto values = co_await read_values(task, keys_of(wanted.values));
  if (!values) co_return tl::unexpected(values.error());
  Settings present{wanted.model, {}, *values, {}};
  co_return present;
}

SettingsAnswer<void> be_of_model(const SettingsTask& task, const Settings& wanted) {
  const auto model = co_await known_model(task);
  if (!model) co_return tl::unexpected(model.error());
  if (*model == wanted.model) co_return tmcl::Result<void>{};
  co_return impossible(fmt::format("the settings are of a {}, and {} is a {}", wanted.model->name,
                                   name_of(task), (*model)->name),
                       "the same number means something else on another model");
}

// ---- nothing moves ------------------------------------------------------------------------------

/// Of each motor of the module.
tmcl::Result<Axes> axes_of(const SettingsTask& task, const tmcl::Model& model) {
  Axes axes;
  for (std::uint8_t motor = 0; motor < model.axes; ++motor) {
    const tmcl::AxisAddress address{task.address, motor};
    auto axis = task.gateway->find_axis(*task.bus, address);
    if (!axis) axis = task.gateway->add_axis(task.bus, address);
    if (!axis) return impossible("too many motors without an axis were named", "restart tmcld");
    axes.push_back(std::move(axis));
  }
  return axes;
}

/// Why a client may not set it. What comes in later is judged again at each command.
std::optional<tmcl::Error> objection_of_owner(const SettingsTask& task, const GatewayAxis& axis) {
  if (task.by_itself) return std::nullopt;
  const auto motor = axis.address();
  const tmcl::Request any_setting{motor.module, tmcl::Command::SAP,
                                  tmcl::axis_parameter::max_velocity, motor.motor, 0};
  const auto& motors = task.bus->motors();
  const auto it = motors.judge(any_setting, task.permit, task.bus->clock().now());
  if (it.verdict.ruling != Ruling::refuse) return std::nullopt;
  return motors.refusal(it.motor, it.verdict.because);
}

SettingsAnswer<std::vector<Claim>> claim_all_of(const SettingsTask& task, const Axes& axes) {
  for (const auto& axis : axes) {
    if (auto objection = objection_of_owner(task, *axis))
      co_return tl::unexpected(*std::move(objection));
    // A search may have ended unseen.
    if (axis->claim_kind() != ClaimKind::search) continue;
    auto free = co_await axis->be_free(axis->begin_movement(task.permit, {}));
    if (!free) co_return tl::unexpected(std::move(free.error()));
  }
  std::vector<Claim> claims;
  for (const auto& axis : axes) {
    if (axis->claim_kind() != ClaimKind::none) co_return tl::unexpected(axis->claimed());
    claims.push_back(axis->claim({ClaimKind::settings, task.permit}));
  }
  co_return claims;
}

SettingsAnswer<bool> turns_by_velocity(const SettingsTask& task, GatewayAxis& axis) {
  const auto mode = tmcl::mode_parameter(axis.parameters());
  if (!mode) co_return false;
  const auto value = co_await run(task, tmcl::verbs::get(axis.address(), mode->number));
  co_return value.map([&](std::int32_t now) { return may_turn_in(*mode, now); });
}

/// It stands, and would stand whatever limit or current it is given.
SettingsAnswer<void> be_at_rest(const SettingsTask& task, GatewayAxis& axis) {
  const auto state = co_await run(task, tmcl::verbs::state(axis.address()));
  if (!state) co_return tl::unexpected(state.error());
  if (state->velocity.value != 0)
    co_return impossible("axis '" + axis.name() + "' moves, and nothing was set",
                         "stop it, and wait until it stands");
  const auto turns = co_await turns_by_velocity(task, axis);
  if (!turns) co_return tl::unexpected(turns.error());
  if (*turns) {
    const auto velocity =
        co_await run(task, tmcl::verbs::get(axis.address(), tmcl::axis_parameter::target_velocity));
    if (!velocity) co_return tl::unexpected(velocity.error());
    if (*velocity == 0) co_return tmcl::Result<void>{};
    co_return impossible("axis '" + axis.name() +
                             "' stands, and would turn if a limit did not keep it: nothing was set",
                         "stop it first");
  }
  if (state->target == state->position) co_return tmcl::Result<void>{};
  co_return impossible(
      "axis '" + axis.name() +
          "' stands short of its target, and another setting may let it go on: "
          "nothing was set",
      "stop it first, or send it to where it stands: 'move " + axis.name() + " 0 --by --internal'");
}

SettingsAnswer<void> have_no_program(const SettingsTask& task) {
  const auto status = co_await run(task, tmcl::verbs::program_status(task.address));
  if (!status && status.error().outcome == tmcl::Outcome::refused) co_return tmcl::Result<void>{};
  if (!status) co_return tl::unexpected(status.error());
  if (status->state != tmcl::ProgramStatus::State::running) co_return tmcl::Result<void>{};
  co_return impossible(
      "a program runs in " + name_of(task) + ", which may move its motors at any time",
      "'tmclctl program stop' ends it");
}

SettingsAnswer<std::vector<Claim>> be_at_rest(const SettingsTask& task, const Axes& axes) {
  auto claims = co_await claim_all_of(task, axes);
  if (!claims) co_return claims;
  auto alone = co_await have_no_program(task);
  if (!alone) co_return tl::unexpected(std::move(alone.error()));
  for (const auto& axis : axes) {
    auto rests = co_await be_at_rest(task, *axis);
    if (!rests) co_return tl::unexpected(std::move(rests.error()));
  }
  co_return claims;
}

// ---- writing ------------------------------------------------------------------------------------

class Loading {
 public:
  Loading(SettingsTask task, std::shared_ptr<const Settings> wanted)
      : task_(std::move(task)), wanted_(std::move(wanted)) {}

  SettingsAnswer<LoadedSettings> carry_out();

 private:
  /// A line may be slow: what cannot have changed is not read again.
  SettingsAnswer<void> read();
  /// What differs: first what others are counted in.
  SettingsAnswer<void> write_all();
  SettingsAnswer<void> write_some(bool scales);
  SettingsAnswer<void> write(const SettingValue& setting);

  SettingsTask task_;
  std::shared_ptr<const Settings> wanted_;
  Axes axes_;
  Settings present_;
  LoadedSettings loaded_;
};

SettingsAnswer<void> Loading::write(const SettingValue& setting) {
  RunOptions options;
  options.permit = task_.by_itself ? Permit{} : task_.permit;
  const auto& key = setting.key;
  if (key.scope == SettingScope::motor)
    return axes_.at(key.motor)->set(key.number, setting.value, std::move(options));
  const auto bank = key.scope == SettingScope::interrupts ? tmcl::global_bank::interrupts
                                                          : tmcl::global_bank::parameters;
  return run(task_, tmcl::verbs::set_global(task_.address, bank, key.number, setting.value));
}

SettingsAnswer<void> Loading::read() {
  auto present = co_await read_present(task_, *wanted_);
  if (!present) co_return tl::unexpected(std::move(present.error()));
  present_ = std::move(*present);
  co_return tmcl::Result<void>{};
}

SettingsAnswer<void> Loading::write_some(bool scales) {
  const auto written_before = loaded_.written.size();
  const auto settings = in_loading_order(*wanted_);
  for (const auto& setting : settings) {
    const auto before = present_.find(setting.key);
    if (is_scale(*wanted_->model, setting.key) != scales || before == setting.value) continue;
    auto written = co_await write(setting);
    module_of(task_).note_settings_changed();
    if (written) {
      loaded_.written.push_back({setting.key, before, setting.value});
    } else if (written.error().outcome == tmcl::Outcome::refused ||
               written.error().code == tmcl::Errc::bad_argument) {
      loaded_.refused.push_back({setting, std::move(written.error())});
    } else {
      if (!loaded_.written.empty()) written.error().outcome = tmcl::Outcome::unknown;
      co_return written;
    }
    task_.tell(fmt::format("{} settings written", loaded_.written.size()));
  }
  if (loaded_.written.size() == written_before) co_return tmcl::Result<void>{};
  auto again = co_await read();
  co_return again;
}

SettingsAnswer<void> Loading::write_all() {
  for (const bool scales : {true, false}) {
    auto written = co_await write_some(scales);
    if (!written) co_return written;
  }
  co_return tmcl::Result<void>{};
}

SettingsAnswer<LoadedSettings> Loading::carry_out() {
  auto fits = co_await be_of_model(task_, *wanted_);
  if (!fits) co_return tl::unexpected(std::move(fits.error()));
  auto axes = axes_of(task_, *wanted_->model);
  if (!axes) co_return tl::unexpected(std::move(axes.error()));
  axes_ = std::move(*axes);
  const auto claims = co_await be_at_rest(task_, axes_);
  if (!claims && claims.error().code == tmcl::Errc::bad_argument) {
    loaded_.objection = claims.error();
    co_return std::move(loaded_);
  }
  if (!claims) co_return tl::unexpected(claims.error());
  auto done = co_await read();
  if (done) done = co_await write_all();
  // What was refused beside the old value of another setting is tried once more.
  if (done && !loaded_.refused.empty() && !loaded_.written.empty()) {
    loaded_.refused.clear();
    done = co_await write_all();
  }
  if (!done) co_return tl::unexpected(std::move(done.error()));
  loaded_.differing = what_to_load(present_, *wanted_);
  co_return std::move(loaded_);
}

}  // namespace

SettingsAnswer<Settings> read_settings(SettingsTask task) {
  const auto model = co_await known_model(task);
  if (!model) co_return tl::unexpected(model.error());
  const auto values = co_await read_values(task, keys_of(settings_of(**model)));
  if (!values) co_return tl::unexpected(values.error());
  const auto apart = co_await read_values(task, keys_of(kept_apart(**model)));
  if (!apart) co_return tl::unexpected(apart.error());
  Settings settings{*model, to_string(module_of(task).identity()->version), *values, *apart};
  co_return settings;
}

SettingsAnswer<std::vector<SettingDifference>> compare_settings(
    SettingsTask task, std::shared_ptr<const Settings> wanted) {
  auto fits = co_await be_of_model(task, *wanted);
  if (!fits) co_return tl::unexpected(std::move(fits.error()));
  const auto present = co_await read_present(task, *wanted);
  if (!present) co_return tl::unexpected(present.error());
  co_return what_to_load(*present, *wanted);
}

SettingsAnswer<LoadedSettings> load_settings(SettingsTask task,
                                             std::shared_ptr<const Settings> wanted) {
  Loading loading(std::move(task), std::move(wanted));
  auto loaded = co_await loading.carry_out();
  co_return loaded;
}

SettingsAnswer<KeptSettings> store_settings(SettingsTask task, std::vector<SettingKey> keys) {
  KeptSettings kept;
  for (const auto& key : keys) {
    // The module keeps those by itself.
    if (key.scope == SettingScope::global) continue;
    auto stored = co_await run(task, tmcl::verbs::store_setting(task.address, key));
    if (stored) {
      ++kept.stored;
    } else if (stored.error().outcome == tmcl::Outcome::refused) {
      kept.refused.push_back({{key, 0}, std::move(stored.error())});
    } else {
      co_return tl::unexpected(std::move(stored.error()));
    }
    task.tell(fmt::format("{} of {} settings stored", kept.stored, keys.size()));
  }
  co_return kept;
}

std::string describe(const SettingDifference& difference, const tmcl::Model& of) {
  const auto infos = settings_of(of);
  const auto* info = find_setting(infos, difference.key);
  const auto name = describe(difference.key, info == nullptr ? std::string_view("?") : info->name);
  if (!difference.present) return name + " is not there";
  return fmt::format("{} is {}, not {}", name, *difference.present, difference.wanted);
}

}  // namespace tmcld
