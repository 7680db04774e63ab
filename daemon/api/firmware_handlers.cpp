// New firmware for modules.
#include "api/handlers.hpp"
#include "api/module_choice.hpp"
#include "tmcl/firmware_verbs.hpp"
#include "tmcl/hex.hpp"
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

/// Bytes "offset" and following.
Lookup<std::vector<std::uint8_t>> part_of(const Call& call) {
  const auto held = call.gateway->image_shelf.size_for(call.peer);
  const auto offset = static_cast<std::size_t>(call.params.integer("offset"));
  if (offset != 0 && offset != held) {
    return tl::unexpected(param_error("bad_argument", "offset",
                                      "of this client's image there are " + std::to_string(held) +
                                          " bytes, so these cannot be those from " +
                                          std::to_string(offset) + " on",
                                      "begin again with offset 0"));
  }
  auto bytes = tmcl::from_hex(call.params.text("data"));
  if (!bytes)
    return tl::unexpected(param_error("bad_argument", "data", "'data': " + bytes.error()));
  if (offset + bytes->size() <= ImageShelf::most_bytes) return std::move(*bytes);
  return tl::unexpected(
      param_error("out_of_range", "data",
                  "an image has at most " + std::to_string(ImageShelf::most_bytes) + " bytes"));
}

Lookup<Image> take_image(const Call& call) {
  auto& shelf = call.gateway->image_shelf;
  const auto held = shelf.size_for(call.peer);
  const auto wanted = static_cast<std::size_t>(call.params.integer("bytes"));
  if (held == wanted)
    return Image{static_cast<std::uint32_t>(call.params.integer("start")), shelf.take()};
  return tl::unexpected(param_error("bad_argument", "bytes",
                                    "of this client's image there are " + std::to_string(held) +
                                        " bytes, and not " + std::to_string(wanted),
                                    "hand it over by firmware.stage, all of it, right before"));
}

/// Goes on when nobody listens any more: a firmware in part is of no use to anyone.
tmcl::FirmwareOptions options_for(const Call& call, const ModuleChoice& module) {
  tmcl::FirmwareOptions options;
  options.force = call.params.boolean_or("force", false);
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

Answer stage_firmware(Call& call) {
  const auto part = part_of(call);
  if (!part) co_return tl::unexpected(part.error());
  auto& shelf = call.gateway->image_shelf;
  if (call.params.integer("offset") == 0) shelf.begin(call.peer);
  shelf.append(*part);
  json::object result;
  result["bytes"] = shelf.size_for(call.peer);
  co_return result;
}

Answer upload_firmware(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  auto image = take_image(call);
  if (!image) co_return tl::unexpected(std::move(image.error()));
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
