// firmware info, firmware check, firmware upload.
#include <fmt/format.h>

#include "input_file.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/model.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

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

void show(const tmcl::FirmwareProgress& progress, ProgressLine& line) {
  if (progress.step != "writing") return line.show(progress.step);
  const auto fraction = static_cast<double>(progress.written) / static_cast<double>(progress.of);
  line.show(fmt::format("writing {} {} of {} bytes",
                        bar(fraction, usual_bar_width, line.screen().utf8), progress.written,
                        progress.of));
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

}  // namespace

VerbResult run(const verb::FirmwareInfo& verb, Output& output) {
  return read_image(verb.file).map([&](const Image& image) {
    if (output.json) {
      print_json(to_json(verb.file, image), output);
    } else {
      print_image(verb.file, image, output.out);
    }
    return ExitCode::done;
  });
}

VerbResult run(const verb::CheckFirmware& verb, Context& context) {
  const auto image = read_image(verb.file);
  if (!image) return tl::unexpected(image.error());
  const auto module = parse_module(verb.module);
  if (!module) return tl::unexpected(module.error());
  const auto match = context.target.match_firmware(*module, *image);
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

VerbResult run(const verb::UploadFirmware& verb, Context& context) {
  const auto image = read_image(verb.file);
  if (!image) return tl::unexpected(image.error());
  const auto module = parse_module(verb.module);
  if (!module) return tl::unexpected(module.error());
  ProgressLine line(context.output);
  tmcl::FirmwareOptions options;
  options.force = verb.force;
  options.progress = [&](const tmcl::FirmwareProgress& progress) { show(progress, line); };
  const auto done = context.target.upload_firmware(*module, *image, options);
  line.clear();
  if (!done) return tl::unexpected(done.error());
  report(verb, *module, *image, *done, context.output);
  return ExitCode::done;
}

}  // namespace tmclctl
