#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t addresses_at_once = 32;
constexpr std::uint8_t most_axes = 16;
// A second module of the same address answers within this time of the first.
constexpr Duration second_reply_time = 10ms;

Request version_request(ModuleAddress module) {
  return {module, Command::GET_FIRMWARE_VERSION, static_cast<std::uint8_t>(VersionForm::binary), 0,
          0};
}

/// For a model that no table knows: motors that exist have a position.
Script<Result<std::uint8_t>> count_axes(ModuleAddress module) {
  std::uint8_t axes = 0;
  while (axes < most_axes) {
    const auto position =
        co_await must(unless_refused(get({module, axes}, axis_parameter::actual_position)));
    if (!position) break;
    ++axes;
  }
  co_return axes;
}

/// A bootloader tells its version as a firmware does, but knows no motors. Some say nothing at all
/// to what they do not know.
Script<Result<bool>> runs_bootloader(ModuleAddress module) {
  const auto position = co_await get({module, 0}, axis_parameter::actual_position);
  if (position) co_return false;
  const auto& error = position.error();
  if (!is_silence(error) && error.outcome != Outcome::refused) co_return tl::unexpected(error);
  if (!is_silence(error) && !is_unknown_command(error)) co_return false;
  co_return co_await is_in_bootloader(module);
}

/// Whether firmware runs in it, and how many motors it has.
Script<Result<void>> look_closer(FoundModule& found) {
  const auto* model = find_model(found.version.model);
  if (model != nullptr) found.model = model->name;
  if (model != nullptr) found.axes = model->axes;
  found.version.bootloader = co_await must(runs_bootloader(found.address));
  if (model == nullptr) found.axes = co_await must(count_axes(found.address));
  co_return Result<void>{};
}

/// A module that gets new firmware is not there for anybody else.
bool is_absence(const Error& error) {
  return is_silence(error) || error.code == Errc::in_bootloader;
}

}  // namespace

Script<Result<FoundModule>> identify(ModuleAddress module) {
  // A module that knows the command but not this form is there all the same.
  const auto first = co_await must(unless_refused(ask(version_request(module))));
  FoundModule found{module, first ? version_from_value(*first) : FirmwareVersion{}, {}, 0, false};

  co_await pause(second_reply_time);
  const auto again = co_await exchange(version_request(module));
  found.duplicate_suspected = again && again->duplicate_suspected;

  auto seen = co_await look_closer(found);
  // Others answer as well: it is there, and nothing that is read can be told from theirs.
  const bool is_unclear = !seen && seen.error().code == Errc::unexpected_value;
  if (!seen && !is_unclear) co_return tl::unexpected(std::move(seen.error()));
  found.duplicate_suspected = found.duplicate_suspected || is_unclear;
  co_return found;
}

Script<Result<std::vector<FoundModule>>> scan(ScanOptions options) {
  std::vector<FoundModule> found;
  if (options.first > options.last)
    co_return tl::unexpected(bad_argument("the first address is above the last"));
  const std::size_t total = options.last - options.first + 1U;
  for (std::size_t asked = 0; asked < total;) {
    std::vector<step::Exchange> group;
    const auto size = std::min(addresses_at_once, total - asked);
    for (std::size_t i = 0; i < size; ++i) {
      const ModuleAddress address{static_cast<std::uint16_t>(options.first + asked + i)};
      group.push_back({version_request(address), {std::nullopt, options.reply_timeout, 1}});
    }
    const auto requests = group;
    const auto answers = co_await exchange_all(std::move(group));
    for (std::size_t i = 0; i < size; ++i) {
      if (!answers[i] && is_absence(answers[i].error())) continue;
      const auto module = co_await identify(requests[i].request.address);
      // What fell silent again since is noise rather than a module.
      if (!module && is_absence(module.error())) continue;
      if (!module) co_return tl::unexpected(module.error());
      found.push_back(*module);
      if (options.found) options.found(*module);
    }
    asked += size;
    if (options.progress) options.progress(asked, total);
  }
  co_return found;
}

}  // namespace tmcl::verbs

namespace tmcl {

Error no_firmware(ModuleAddress module) {
  Error error{Errc::in_bootloader, Outcome::not_sent, {}, {}, {}, {}, {}};
  error.message =
      fmt::format("module {} is in its bootloader: no firmware runs in it that could do anything",
                  number(module));
  error.hint =
      "'tmclctl firmware upload' gives it one; one that is whole starts when the module's power is "
      "switched off and on";
  return error;
}

}  // namespace tmcl
