// New firmware for modules.
#include "api/handlers.hpp"
#include "api/module_choice.hpp"
#include "api/staging.hpp"
#include "api/views.hpp"
#include "tmcl/firmware_verbs.hpp"
#include "tmcl/model.hpp"

namespace tmcld::handlers {
namespace {

using tmcl::firmware::Image;

std::string text_of(tmcl::FirmwareVersion version) {
  const auto text = to_text(version);
  return {text.begin(), text.end()};
}

Result<Image> take_image(const Call& call, const firmware::Upload& params) {
  return take_staged(call, staged_image, params.bytes).map([&](std::vector<std::uint8_t> bytes) {
    return Image{params.start, std::move(bytes)};
  });
}

/// Counts as work that the end of the daemon waits for.
class UploadInProgress {
 public:
  UploadInProgress(std::shared_ptr<Gateway> gateway, const ModuleChoice& module)
      : gateway_(std::move(gateway)),
        here_(gateway_->uploads.insert("module " + std::to_string(number(module.address)) + " of " +
                                       module.bus->name())) {}
  UploadInProgress(const UploadInProgress&) = delete;
  UploadInProgress& operator=(const UploadInProgress&) = delete;
  ~UploadInProgress() { gateway_->uploads.erase(here_); }

 private:
  std::shared_ptr<Gateway> gateway_;
  std::multiset<std::string>::iterator here_;
};

tmcl::Error daemon_is_ending() {
  return tmcl::not_sent(tmcl::Errc::daemon_ending, "the daemon is ending",
                        "nothing was changed; upload it again when the daemon runs");
}

/// Goes on when its client has gone: a firmware in part is of no use to anyone.
tmcl::FirmwareOptions options_for(const Call& call, const firmware::Upload& params) {
  tmcl::FirmwareOptions options;
  options.force = params.force.value_or(false);
  options.objection = [gateway = call.gateway]() -> std::optional<tmcl::Error> {
    if (!gateway->is_closing()) return std::nullopt;
    return daemon_is_ending();
  };
  options.progress = [tell = call.progress_reporter(), bus = params.bus,
                      address = params.address](const tmcl::FirmwareProgress& progress) {
    tell(LoadProgress{bus, address, std::string(progress.step), progress.written, progress.of});
  };
  return options;
}

}  // namespace

Answer<firmware::Status> firmware_status(Call& call, const firmware::Status& params) {
  const auto module = co_await must(module_of(call, params));
  auto script = tmcl::verbs::match_firmware(module.address, {});
  auto match = co_await must(run_on(module, call, std::move(script)));
  co_return firmware::FirmwareState{name_if_known(tmcl::find_model(match.model)), match.model,
                                    text_of(match.running), match.in_bootloader};
}

Answer<firmware::Stage> stage_firmware(Call& call, const firmware::Stage& params) {
  co_return stage_part(call, {params.offset, params.data}, staged_image);
}

Answer<firmware::Upload> upload_firmware(Call& call, const firmware::Upload& params) {
  const auto module = co_await must(module_of(call, params));
  // Before its motors are stopped.
  const tmcl::Request entry{module.address, tmcl::Command::ENTER_BOOTLOADER, 0, 0, 0};
  co_await must(run_on(module, call, module.bus->gate().may_send(entry, call.permit)));
  auto image = co_await must(take_image(call, params));
  const UploadInProgress in_progress(call.gateway, module);
  auto script =
      tmcl::verbs::upload_firmware(module.address, std::move(image), options_for(call, params));
  auto report = co_await run_on(module, call, std::move(script));
  expect_news(module);
  if (!report) co_return tl::unexpected(std::move(report.error()));
  const auto& before = report->before;
  co_return firmware::Exchange{name_if_known(tmcl::find_model(before.model)), before.model,
                               text_of(before.running), text_of(report->after), report->checksum};
}

}  // namespace tmcld::handlers
