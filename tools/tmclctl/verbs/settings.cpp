// settings: those of a module as a file.
#include <filesystem>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "command_line/input_file.hpp"
#include "command_line/text_problems.hpp"
#include "config/settings_file.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/settings.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;
using tmcl::Settings;

/// Calls a method that tells its progress.
template <class Method>
Result<typename Method::Result> call(const Method& method, std::string_view what,
                                     Context& context) {
  ProgressLine line(context.output);
  const tmcl::client::Hearing<api::settings::Progress> hearing(
      context.gateway.caller, api::progress_notification,
      [&](const api::settings::Progress& progress) {
        line.show(fmt::format("{}: {}", what, progress.text));
      });
  return context.call(method);
}

template <class Method>
Result<Method> on(const std::string& module, Context& context) {
  return on_module(module, context).map([](const api::OnModule& named) {
    Method method;
    method.bus = named.bus;
    method.address = named.address;
    return method;
  });
}

Result<api::settings::Settings> read(const std::string& module, Context& context) {
  return on<api::settings::Read>(module, context).and_then([&](const api::settings::Read& method) {
    return call(method, "module " + module, context);
  });
}

Result<std::string> text_of(const std::string& file) {
  auto text = read_file(file, tmcld::max_settings_bytes + 1);
  if (text) return *std::move(text);
  return tl::unexpected(
      usage_error("cannot_read", fmt::format("cannot read {}: {}", file, text.error())));
}

Result<Settings> settings_in(const std::string& text, const std::string& file, Output& output) {
  auto settings = tmcld::parse_settings(text);
  if (settings) return *std::move(settings);
  const auto& problems = settings.error();
  return tl::unexpected(error_from(file, problems, problems.size() + 1, output, "bad_settings"));
}

/// "motor.0", "max_current", ...
std::vector<std::string> place_of(const api::settings::Place& place) {
  return {place.section, place.parameter};
}

json::object with_module(const std::string& module, json::object document) {
  document["module"] = module;
  return document;
}

// ---- save, show

Result<void> save(const std::string& module, const std::string& file, Context& context) {
  OutputFile output;
  if (auto opened = output.open(file); !opened) return opened;
  const auto settings = read(module, context);
  if (!settings) return tl::unexpected(settings.error());
  if (auto written = output.write(settings->toml); !written) return written;
  if (file.empty()) {
    if (context.output.json) {
      print_json(with_module(module, api::to_json(*settings)), context.output);
    } else {
      context.output.out << settings->toml;
    }
  } else if (context.output.json) {
    print_json({{"module", module}, {"model", settings->model}, {"file", file}}, context.output);
  } else {
    context.output.out << fmt::format("{}: {} settings of module {}, a {}\n", file,
                                      settings->settings.size(), module, settings->model);
  }
  return {};
}

/// Each module of a bus as DIR/BUS-ADDRESS.toml.
Result<ExitCode> save_bus(const verb::SettingsSave& verb, Context& context) {
  const auto bus = bus_named(verb.bus, context);
  if (!bus) return tl::unexpected(bus.error());
  const auto modules = modules_of(context);
  if (!modules) return tl::unexpected(modules.error());
  std::error_code failure;
  std::filesystem::create_directories(verb.file, failure);
  if (failure)
    return tl::unexpected(usage_error("cannot_write", fmt::format("cannot make the folder {}: {}",
                                                                  verb.file, failure.message())));
  std::size_t saved = 0;
  for (const auto& module : *modules) {
    if (module.bus != bus->name) continue;
    const auto file = fmt::format("{}/{}-{}.toml", verb.file, module.bus, module.address);
    const auto done = save(fmt::format("{}:{}", module.bus, module.address), file, context);
    if (!done) return tl::unexpected(done.error());
    ++saved;
  }
  if (saved > 0) return ExitCode::done;
  return tl::unexpected(usage_error("no_module", "there is no module on bus " + bus->name,
                                    "'tmclctl scan' looks for modules"));
}

Result<ExitCode> run(const verb::SettingsSave& verb, Context& context) {
  if (verb.module.empty()) return save_bus(verb, context);
  return save(verb.module, verb.file, context).map([] { return ExitCode::done; });
}

std::string value_text(const api::settings::Setting& setting) {
  return fmt::format("{}{}{}", setting.value, setting.unit ? " " : "", setting.unit.value_or(""));
}

Result<ExitCode> run(const verb::SettingsShow& verb, Context& context) {
  auto settings = read(verb.module, context);
  if (!settings) return tl::unexpected(settings.error());
  if (verb.changed)
    std::erase_if(settings->settings, [](const auto& one) { return one.value == one.initial; });
  if (context.output.json) {
    print_json(with_module(verb.module, api::to_json(*settings)), context.output);
    return ExitCode::done;
  }
  Table table({"SECTION", "SETTING", "VALUE", "NEW MODULE", "MEANING"});
  for (const auto& one : settings->settings) {
    auto cells = place_of(one);
    const bool is_changed = one.value != one.initial;
    cells.insert(cells.end(),
                 {value_text(one), is_changed ? std::to_string(one.initial) : "", one.meaning});
    table.add(std::move(cells));
  }
  table.print(context.output);
  return ExitCode::done;
}

// ---- diff

/// A module is its address; a file has a dot or a slash in its name.
bool is_file(const std::string& text) { return text.find_first_of("./") != std::string::npos; }

Result<Settings> settings_of_file(const std::string& file, Output& output) {
  return text_of(file).and_then(
      [&](const std::string& text) { return settings_in(text, file, output); });
}

Result<Settings> settings_at(const std::string& text, Context& context) {
  if (is_file(text)) return settings_of_file(text, context.output);
  return read(text, context).and_then([&](const api::settings::Settings& settings) {
    return settings_in(settings.toml, "module " + text, context.output);
  });
}

struct Row {
  std::vector<std::string> place;
  std::string present;
  std::int32_t wanted;
};

void print(const std::vector<Row>& rows, const std::string& present, const std::string& wanted,
           Output& output) {
  Table table({"SECTION", "SETTING", present, wanted});
  for (const auto& row : rows) {
    auto cells = row.place;
    cells.insert(cells.end(), {row.present, std::to_string(row.wanted)});
    table.add(std::move(cells));
  }
  table.print(output);
}

/// "1 setting", "2 settings"
std::string settings_text(std::size_t count) {
  return fmt::format("{} setting{}", count, count == 1 ? "" : "s");
}

/// As it is said in a sentence or above a column.
std::string shown_name(const std::string& text) { return is_file(text) ? text : "module " + text; }

std::string present_text(const std::optional<std::int32_t>& value) {
  return value ? std::to_string(*value) : "-";
}

Result<ExitCode> show_difference(const verb::SettingsDiff& verb, const Settings& wanted,
                                 const Settings& present, Output& output) {
  if (wanted.model != present.model)
    return tl::unexpected(usage_error(
        "other_model",
        fmt::format("{} is of a {}, and {} of a {}", shown_name(verb.wanted), wanted.model->name,
                    shown_name(verb.present), present.model->name)));
  const auto infos = settings_of(*wanted.model);
  std::vector<Row> rows;
  json::array list;
  for (const auto& one : what_to_load(present, wanted)) {
    const auto name = find_setting(infos, one.key)->name;
    rows.push_back({{section_of(one.key), name}, present_text(one.present), one.wanted});
    json::object object{{"section", section_of(one.key)}, {"parameter", name}};
    object["present"] = one.present ? json::value(*one.present) : json::value(nullptr);
    object["wanted"] = one.wanted;
    list.push_back(std::move(object));
  }
  if (output.json) {
    print_json({{"wanted", verb.wanted}, {"present", verb.present}, {"differences", list}}, output);
  } else if (rows.empty()) {
    output.out << fmt::format("{} has what {} says\n", shown_name(verb.present),
                              shown_name(verb.wanted));
  } else {
    print(rows, shown_name(verb.present), shown_name(verb.wanted), output);
  }
  return rows.empty() ? ExitCode::done : ExitCode::refused;
}

Result<ExitCode> run(const verb::SettingsDiff& verb, Context& context) {
  const auto wanted = settings_at(verb.wanted, context);
  if (!wanted) return tl::unexpected(wanted.error());
  const auto present = settings_at(verb.present, context);
  if (!present) return tl::unexpected(present.error());
  return show_difference(verb, *wanted, *present, context.output);
}

Result<ExitCode> run_on_files(const verb::SettingsDiff& verb, Output& output) {
  const auto wanted = settings_of_file(verb.wanted, output);
  if (!wanted) return tl::unexpected(wanted.error());
  const auto present = settings_of_file(verb.present, output);
  if (!present) return tl::unexpected(present.error());
  return show_difference(verb, *wanted, *present, output);
}

// ---- load

std::vector<Row> rows_of(const std::vector<api::settings::Difference>& differences) {
  std::vector<Row> rows;
  for (const auto& one : differences)
    rows.push_back({place_of(one), present_text(one.present), one.wanted});
  return rows;
}

Result<ExitCode> try_to_load(const verb::SettingsLoad& verb, const std::string& toml,
                             Context& context) {
  auto method = on<api::settings::Compare>(verb.module, context);
  if (!method) return tl::unexpected(method.error());
  method->toml = toml;
  const auto found = call(*method, "module " + verb.module, context);
  if (!found) return tl::unexpected(found.error());
  if (context.output.json) {
    print_json(with_module(verb.module, api::to_json(*found)), context.output);
  } else if (found->differences.empty()) {
    context.output.out << fmt::format("module {} has what {} says\n", verb.module, verb.file);
  } else {
    print(rows_of(found->differences), "NOW", "WOULD BE", context.output);
    context.output.out << "nothing was written\n";
  }
  return ExitCode::done;
}

void tell(const verb::SettingsLoad& verb, const api::settings::Loaded& loaded, Output& output) {
  if (!loaded.written.empty()) print(rows_of(loaded.written), "BEFORE", "NOW", output);
  output.out << fmt::format("module {}: {} written", verb.module,
                            settings_text(loaded.written.size()));
  if (verb.store) {
    output.out << fmt::format(", {} stored\n", loaded.stored);
  } else if (loaded.written.empty()) {
    output.out << ": it has what the file says\n";
  } else {
    output.out << "; that holds until it loses power: --store keeps it\n";
  }
}

Result<ExitCode> run(const verb::SettingsLoad& verb, Context& context) {
  auto toml = text_of(verb.file);
  if (!toml && is_file(verb.module) && !is_file(verb.file))
    toml.error().hint =
        fmt::format("The file comes first: settings load {} {}", verb.module, verb.file);
  if (!toml) return tl::unexpected(toml.error());
  // All problems, each with its line.
  const auto parsed = settings_in(*toml, verb.file, context.output);
  if (!parsed) return tl::unexpected(parsed.error());
  if (verb.dry_run) return try_to_load(verb, *toml, context);
  auto method = on<api::settings::Load>(verb.module, context);
  if (!method) return tl::unexpected(method.error());
  method->toml = *toml;
  method->store = verb.store;
  const auto loaded = call(*method, "module " + verb.module, context);
  if (!loaded) return tl::unexpected(loaded.error());
  std::set<std::vector<std::string>> refused;
  for (const auto& one : loaded->refused) {
    refused.insert(place_of(one));
    warn(fmt::format("{} {} is refused: {}", one.section, one.parameter, one.why), context.output);
  }
  for (const auto& one : loaded->differing)
    if (!refused.contains(place_of(one)))
      warn(fmt::format("{} {} is {} afterwards, not {}", one.section, one.parameter,
                       present_text(one.present), one.wanted),
           context.output);
  if (context.output.json) {
    print_json(with_module(verb.module, api::to_json(*loaded)), context.output);
  } else {
    tell(verb, *loaded, context.output);
  }
  const bool is_as_wanted = loaded->refused.empty() && loaded->differing.empty();
  return is_as_wanted ? ExitCode::done : ExitCode::refused;
}

constexpr const char* settings_help = R"(
The settings of a module are what it can keep in its EEPROM and what can be given to another module of
its model: currents, ramps, microsteps, switches, stallGuard, interrupts. A file has them by their names,
in TOML, with units. Positions, targets and coordinates are none, nor is what belongs to one module:
address, baud rates, heartbeats, its program. A file tells some of these as comments; they are never loaded.

  tmclctl settings save 1 -o stage.toml          a file of module 1
  tmclctl settings save --bus bench -o folder    folder/bench-1.toml, folder/bench-2.toml, ...
  tmclctl settings show 1 --changed              what a new module has otherwise
  tmclctl settings diff stage.toml 1             what loading it would change; exit status 1 if anything
  tmclctl settings load stage.toml 1 --dry-run   the same, and nothing is written
  tmclctl settings load stage.toml 1 --store     sets it, and keeps it in the EEPROM

A file may have some of the settings only: the others are left as they are. To load it, all motors of
the module must stand where they were sent to and no program may run in it: then nothing moves. What
the module refuses, and what is not as in the file afterwards, is said, and the exit status is 1.
In diff, what has a dot or a slash in its name is a file, and anything else a module.
)";

}  // namespace

void add_settings(Grammar& grammar) {
  const auto group =
      grammar.group("settings", "Keep the settings of a module in a file", settings_help);
  auto save = grammar.verb<verb::SettingsSave>(group, "save", access::reads, "Write them to a file",
                                               settings_help, run);
  save.optional_word("MODULE", module_meaning, text(save->module));
  save.option("--bus", "NAME", "All modules of this bus, a file each; -o is their folder",
              text(save->bus));
  save.option("-o,--output", "FILE", "Where to; standard output without", text(save->file));
  save.object([](const verb::SettingsSave& said, bool) {
    if (said.module.empty() == said.bus.empty()) return "name a module, or a bus with --bus";
    return !said.bus.empty() && said.file.empty() ? "--bus needs -o, a folder" : "";
  });
  auto show = grammar.verb<verb::SettingsShow>(group, "show", access::reads, "Show them",
                                               settings_help, run);
  show.module(show->module);
  show.flag("--changed", "Only what a new module has otherwise", show->changed);
  auto diff = grammar.verb<verb::SettingsDiff>(
      group, "diff", access::reads, "Show what loading A into B would change", settings_help, run);
  diff.word("A", "File or module", text(diff->wanted));
  diff.word("B", "File or module", text(diff->present));
  diff.alone(
      [](const verb::SettingsDiff& said) { return is_file(said.wanted) && is_file(said.present); },
      run_on_files);
  auto load = grammar.verb<verb::SettingsLoad>(group, "load", access::acts,
                                               "Set a module as a file says", settings_help, run);
  load.word("FILE", "File of settings", text(load->file));
  load.module(load->module);
  load.flag("--dry-run", "Only show what would be written", load->dry_run);
  load.flag("--store", "Keep what the file says in the EEPROM, too", load->store);
}

}  // namespace tmclctl
