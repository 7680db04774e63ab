// firmware info, firmware check, firmware upload.
#include <fmt/format.h>

#include "command_line/input_file.hpp"
#include "connection/staging.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/firmware_verbs.hpp"
#include "tmcl/model.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;
using tmcl::FirmwareMatch;
using tmcl::FirmwareVersion;
using tmcl::firmware::address_text;
using tmcl::firmware::Image;

std::string text_of(FirmwareVersion version) {
  const auto text = to_text(version);
  return {text.begin(), text.end()};
}

std::string model_name(std::uint16_t number) {
  const auto* model = tmcl::find_model(number);
  return model != nullptr ? std::string(model->name) : fmt::format("unknown model {}", number);
}

/// "firmware 1.42 of a TMCM-1110"
std::string describe(FirmwareVersion version) {
  return fmt::format("{} {} of a {}", version.bootloader ? "bootloader" : "firmware",
                     to_string(version), model_name(version.model));
}

Result<Image> read_image(const std::string& path) {
  const auto contents = read_file(path, tmcl::firmware::most_file_bytes + 1);
  if (!contents) {
    return tl::unexpected(
        usage_error("cannot_read", fmt::format("cannot read {}: {}", path, contents.error())));
  }
  return tmcl::firmware::read_intel_hex(*contents).map_error([&](const tmcl::TextProblem& problem) {
    auto failure = usage_error("bad_firmware", describe(problem, path),
                               "Firmware comes as an Intel HEX file; get it again");
    failure.subject["file"] = path;
    failure.subject["line"] = problem.line;
    failure.subject["column"] = problem.column;
    failure.subject["word"] = problem.word;
    return failure;
  });
}

json::object to_json(const std::string& path, const Image& image) {
  json::array versions;
  for (const auto& version : versions_in(image)) {
    const auto* model = tmcl::find_model(version.model);
    versions.push_back(
        json::object{{"text", text_of(version)},
                     {"model_number", version.model},
                     {"model", model != nullptr ? json::value(model->name) : json::value(nullptr)},
                     {"firmware", to_string(version)}});
  }
  return {{"file", path},
          {"start", image.start},
          {"bytes", image.bytes.size()},
          {"checksum", checksum(image)},
          {"versions", std::move(versions)}};
}

void print_image(const std::string& path, const Image& image, std::ostream& out) {
  const auto last = image.start + static_cast<std::uint32_t>(image.bytes.size()) - 1;
  out << fmt::format("{}: {} bytes, {} to {}, checksum 0x{:08X}\n", path, image.bytes.size(),
                     address_text(image.start), address_text(last), checksum(image));
  const auto versions = versions_in(image);
  for (const auto& version : versions)
    out << "  " << describe(version) << " (" << text_of(version) << ")\n";
  if (versions.empty()) out << "  it does not say for which model it is\n";
}

json::object to_json(const ModuleName& module, const FirmwareMatch& match) {
  return {{"address", module.address},
          {"model_number", match.model},
          {"running", text_of(match.running)},
          {"in_bootloader", match.in_bootloader},
          {"offered", match.version ? json::value(text_of(*match.version)) : json::value(nullptr)}};
}

Error mismatch(const std::string& path, const ModuleName& module, const FirmwareMatch& match) {
  std::string offered;
  for (const auto& version : match.offered)
    offered += (offered.empty() ? "" : ", ") + text_of(version);
  auto failure =
      usage_error("wrong_firmware",
                  fmt::format("{} is {}; module {} has {}", path,
                              offered.empty() ? "for no model that it names" : "for " + offered,
                              module.address, describe(match.running)),
                  "Look for the firmware of this model");
  failure.subject["module"] = to_json(module, match);
  return failure;
}

void show(const api::LoadProgress& progress, ProgressLine& line) {
  if (progress.phase != "writing") return line.show(progress.phase);
  const auto fraction = static_cast<double>(progress.done) / static_cast<double>(progress.of);
  line.show(fmt::format("writing {} {} of {} bytes",
                        bar(fraction, usual_bar_width, line.screen().utf8), progress.done,
                        progress.of));
}

// A module may say nothing for so long while it erases its firmware, three times.
constexpr auto longest_firmware_step = std::chrono::seconds(75);

FirmwareMatch match_from(std::uint16_t model, const std::string& running, const Image& image) {
  FirmwareMatch match;
  match.model = model;
  match.running = tmcl::version_from_text(running).value_or(FirmwareVersion{});
  match.in_bootloader = match.running.bootloader;
  match.offered = versions_in(image);
  match.version = version_for(image, match.model);
  return match;
}

Result<tmcl::FirmwareReport> exchange(const verb::UploadFirmware& verb, const api::OnModule& module,
                                      const Image& image, Context& context) {
  const auto staged = stage<api::firmware::Stage>(image.bytes, context);
  if (!staged) return tl::unexpected(staged.error());
  ProgressLine line(context.output);
  const tmcl::client::Hearing<api::LoadProgress> hearing(
      context.gateway.caller, api::progress_notification,
      [&](const api::LoadProgress& news) { show(news, line); });
  const auto size = static_cast<std::uint32_t>(image.bytes.size());
  const api::firmware::Upload upload{module, image.start, size, verb.force};
  return context.call(upload, {.timeout = longest_firmware_step})
      .map([&](const api::firmware::Exchange& done) {
        const auto running = tmcl::version_from_text(done.running);
        return tmcl::FirmwareReport{match_from(done.model_number, done.before, image),
                                    running.value_or(FirmwareVersion{}), done.checksum};
      });
}

void report(const verb::UploadFirmware& verb, const ModuleName& module, const Image& image,
            const tmcl::FirmwareReport& report, Output& output) {
  const auto& offered = report.before.version;
  if (output.json) {
    print_json({{"file", verb.file},
                {"module", to_json(module, report.before)},
                {"bytes", image.bytes.size()},
                {"checksum", report.checksum},
                {"running", text_of(report.after)}},
               output);
    return;
  }
  output.out << fmt::format("module {} runs {} now; before it was {}\n", module.address,
                            describe(report.after), describe(report.before.running));
  if (offered && *offered != report.after)
    warn(fmt::format("{} says that it is {}", verb.file, text_of(*offered)), output);
}

Result<ExitCode> run(const verb::FirmwareInfo& verb, Output& output) {
  return read_image(verb.file).map([&](const Image& image) {
    if (output.json) {
      print_json(to_json(verb.file, image), output);
    } else {
      print_image(verb.file, image, output.out);
    }
    return ExitCode::done;
  });
}

Result<ExitCode> run(const verb::CheckFirmware& verb, Context& context) {
  const auto image = read_image(verb.file);
  if (!image) return tl::unexpected(image.error());
  const auto module = parse_module(verb.module);
  if (!module) return tl::unexpected(module.error());
  const auto named = on_module(*module, context);
  if (!named) return tl::unexpected(named.error());
  const auto match = context.call(api::firmware::Status{{*named}})
                         .map([&](const api::firmware::FirmwareState& status) {
                           return match_from(status.model_number, status.running, *image);
                         });
  if (!match) return tl::unexpected(match.error());
  if (!match->version) return tl::unexpected(mismatch(verb.file, *module, *match));
  if (context.output.json) {
    print_json({{"file", verb.file}, {"module", to_json(*module, *match)}}, context.output);
  } else {
    context.output.out << fmt::format("module {} has {}; {} is {}\n", module->address,
                                      describe(match->running), verb.file,
                                      describe(*match->version));
  }
  return ExitCode::done;
}

Result<ExitCode> run(const verb::UploadFirmware& verb, Context& context) {
  const auto image = read_image(verb.file);
  if (!image) return tl::unexpected(image.error());
  const auto module = parse_module(verb.module);
  if (!module) return tl::unexpected(module.error());
  const auto named = on_module(*module, context);
  if (!named) return tl::unexpected(named.error());
  const auto done = exchange(verb, *named, *image, context);
  if (!done) return tl::unexpected(done.error());
  report(verb, *module, *image, *done, context.output);
  return ExitCode::done;
}

constexpr std::string_view files = "it is about files";

constexpr const char* firmware_help = R"(
  tmclctl firmware info --help
  tmclctl firmware check --help
  tmclctl firmware upload --help
)";

constexpr const char* firmware_info_help = R"(
Reads an Intel HEX file: how long it is, where it goes, its checksum as bootloaders compute it, and
the versions that it says it is, such as 1110V142. What is wrong with a file comes as
FILE:LINE:COLUMN: MESSAGE (exit code 2). No module is needed.

  tmclctl firmware info TMCM-1110_V1.42.hex
)";

constexpr const char* firmware_check_help = R"(
Asks the module which model it is and what it runs, and looks in the file for a version of this
model. Exit code 0 if there is one, otherwise 2. Nothing is changed.

  tmclctl firmware check TMCM-1110_V1.42.hex 1
)";

constexpr const char* firmware_upload_help = R"(
Stops the module's motors, enters its bootloader, erases the firmware, writes the new one, compares
the checksum and starts it. A file that is not for this model is refused before anything is changed;
--force takes it if the file does not say what it is for, or says it in an unknown way.
Through tmcld, everybody else's commands to the module fail meanwhile, stops too: in its bootloader
it can neither start nor stop a motor. The upload goes on to its end even if tmclctl is ended, or
tmcld is asked to end; with --direct the first Ctrl-C does not end it, but the second does. On a serial
line everything waits while the module erases, which may take some seconds.

Whatever fails once the firmware is erased, even the power: the module then stays in its bootloader.
Give the same command again. On USB the module may leave the bus when it enters its bootloader and
come back as another device: give the command again with that one's name.

  tmclctl firmware upload TMCM-1110_V1.42.hex 1
  tmclctl --direct serial:/dev/ttyACM0 firmware upload TMCM-1110_V1.42.hex 1
)";

}  // namespace

void add_firmware(Grammar& grammar) {
  const auto firmware =
      grammar.group("firmware", "Firmware files, and new firmware for a module", firmware_help);
  auto info =
      grammar.verb<verb::FirmwareInfo>(firmware, "info", access::offline(files),
                                       "What is in a firmware file", firmware_info_help, run);
  info.word("FILE", "An Intel HEX file", text(info->file));
  auto check = grammar.verb<verb::CheckFirmware>(firmware, "check", access::reads,
                                                 "Does a firmware file belong to a module?",
                                                 firmware_check_help, run);
  check.word("FILE", "An Intel HEX file", text(check->file));
  check.module(check->module);
  auto upload = grammar.verb<verb::UploadFirmware>(firmware, "upload", access::tells,
                                                   "Exchange the firmware of a module",
                                                   firmware_upload_help, run);
  upload.word("FILE", "An Intel HEX file", text(upload->file));
  upload.module(upload->module);
  upload.flag("--force", "Also a file that does not say that it is for this model", upload->force);
}

}  // namespace tmclctl
