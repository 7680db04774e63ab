// New firmware for modules.
#include "api/handlers.hpp"
#include "api/module_choice.hpp"
#include "api/staging.hpp"
#include "tmcl/firmware_verbs.hpp"
#include "tmcl/model.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
using tmcl::firmware::Image;

std::string text_of(tmcl::FirmwareVersion version) {
  const auto text = to_text(version);
  return {text.begin(), text.end()};
}

json::value name_of_model(std::uint16_t number) {
  const auto* model = tmcl::find_model(number);
  return model == nullptr ? json::value(nullptr) : json::value(model->name);
}

Lookup<Image> take_image(const Call& call) {
  return take_staged(call, staged_image).map([&](std::vector<std::uint8_t> bytes) {
    return Image{static_cast<std::uint32_t>(call.params.integer("start")), std::move(bytes)};
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
  tmcl::Error error;
  error.code = tmcl::Errc::daemon_ending;
  error.outcome = tmcl::Outcome::not_sent;
  error.message = "the daemon is ending";
  error.hint = "nothing was changed; upload it again when the daemon runs";
  return error;
}

/// Goes on when nobody listens any more: a firmware in part is of no use to anyone.
tmcl::FirmwareOptions options_for(const Call& call, const ModuleChoice& module) {
  tmcl::FirmwareOptions options;
  options.force = call.params.boolean_or("force", false);
  options.objection = [gateway = call.gateway]() -> std::optional<tmcl::Error> {
    if (!gateway->is_closing()) return std::nullopt;
    return daemon_is_ending();
  };
  options.progress = [peer = call.peer, id = call.id, bus = module.bus->name(),
                      address = number(module.address)](const tmcl::FirmwareProgress& progress) {
    json::object params;
    params["id"] = id;
    params["bus"] = bus;
    params["address"] = address;
    params["phase"] = progress.step;
    params["done"] = progress.written;
    params["of"] = progress.of;
    peer->notify("notify_progress", std::move(params));
  };
  return options;
}

}  // namespace

Answer firmware_status(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  auto script = tmcl::verbs::match_firmware(module->address, {});
  auto match = co_await run_on(*module, call, std::move(script));
  if (!match) co_return tl::unexpected(std::move(match.error()));
  json::object result;
  result["model"] = name_of_model(match->model);
  result["model_number"] = match->model;
  result["running"] = text_of(match->running);
  result["in_bootloader"] = match->in_bootloader;
  co_return result;
}

Answer stage_firmware(Call& call) { co_return stage_part(call, staged_image); }

Answer upload_firmware(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  // Before its motors are stopped.
  const tmcl::Request entry{module->address, tmcl::Command::ENTER_BOOTLOADER, 0, 0, 0};
  auto may_begin = co_await run_on(*module, call, module->bus->may_send(entry, call.permit));
  if (!may_begin) co_return tl::unexpected(std::move(may_begin.error()));
  auto image = take_image(call);
  if (!image) co_return tl::unexpected(std::move(image.error()));
  const UploadInProgress in_progress(call.gateway, *module);
  auto script =
      tmcl::verbs::upload_firmware(module->address, std::move(*image), options_for(call, *module));
  auto report = co_await run_on(*module, call, std::move(script));
  expect_news(*module);
  if (!report) co_return tl::unexpected(std::move(report.error()));
  json::object result;
  result["model"] = name_of_model(report->before.model);
  result["model_number"] = report->before.model;
  result["before"] = text_of(report->before.running);
  result["running"] = text_of(report->after);
  result["checksum"] = report->checksum;
  co_return result;
}

}  // namespace tmcld::handlers
