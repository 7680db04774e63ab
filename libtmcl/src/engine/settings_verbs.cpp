// The settings of a module, read one by one.
#include "tmcl/settings_verbs.hpp"

#include <algorithm>

#include "engine/verb_steps.hpp"
#include "tmcl/module_verbs.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

/// Read together; other calls have their turns between them.
constexpr std::size_t at_a_time = 8;

std::uint8_t bank_of(SettingScope scope) {
  return scope == SettingScope::interrupts ? global_bank::interrupts : std::uint8_t{0};
}

Request question(ModuleAddress module, const SettingKey& key) {
  if (key.scope == SettingScope::motor) return {module, Command::GAP, key.number, key.motor, 0};
  return {module, Command::GGP, key.number, bank_of(key.scope), 0};
}

}  // namespace

Script<Result<std::vector<SettingValue>>> read_settings(ModuleAddress module,
                                                        std::vector<SettingKey> keys,
                                                        OnSettingsRead progress) {
  std::vector<SettingValue> values;
  for (std::size_t first = 0; first < keys.size(); first += at_a_time) {
    const auto end = std::min(first + at_a_time, keys.size());
    std::vector<step::Exchange> reads;
    for (auto i = first; i < end; ++i)
      reads.push_back({question(module, keys[i]), with_proof(Proof::followed)});
    const auto answers = co_await exchange_all(std::move(reads));
    for (auto i = first; i < end; ++i) {
      const auto& answer = answers[i - first];
      if (answer) {
        values.push_back({keys[i], answer->reply.value});
      } else if (answer.error().outcome != Outcome::refused) {
        co_return tl::unexpected(answer.error());
      }
    }
    if (progress) progress(end, keys.size());
  }
  co_return values;
}

Script<Result<void>> store_setting(ModuleAddress module, SettingKey key) {
  if (key.scope == SettingScope::motor) return store({module, key.motor}, key.number);
  return store_global(module, bank_of(key.scope), key.number);
}

}  // namespace tmcl::verbs
