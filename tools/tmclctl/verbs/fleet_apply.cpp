// fleet apply.
#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "command_line/input_file.hpp"
#include "command_line/text_problems.hpp"
#include "config/settings_file.hpp"
#include "connection/json_read.hpp"
#include "fleet/fleet_answers.hpp"
#include "fleet/text_difference.hpp"
#include "output/print.hpp"
#include "tmcl/api/settings.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;
namespace fs = std::filesystem;

constexpr auto configuration_file = "configuration.toml";
constexpr auto ending_of_files = ".toml";
// A gateway takes calls of 60 kB; the text has escapes there.
constexpr std::size_t most_bytes = 48'000;
// Reading all settings of a module at 9600 Bd.
constexpr tmcl::Duration patience_with_modules = std::chrono::seconds(60);

/// What a folder says of one gateway.
struct GatewayFiles {
  struct Module {
    std::string file;
    std::string bus;
    std::int32_t address = 0;
    std::string toml;
  };
  std::optional<std::string> configuration;
  std::vector<Module> modules;
};
using Files = std::map<std::string, GatewayFiles>;

// ---- the folder ---------------------------------------------------------------------------------

Error file_error(const fs::path& file, const std::string& why, std::string hint = {}) {
  return usage_error("bad_file", fmt::format("{}: {}", file.string(), why), std::move(hint));
}

Result<std::string> text_in(const fs::path& file) {
  auto text = read_file(file.string(), most_bytes + 1);
  if (!text) return tl::unexpected(file_error(file, text.error()));
  if (text->size() > most_bytes)
    return tl::unexpected(file_error(file, fmt::format("has more than {} bytes", most_bytes)));
  return std::move(*text);
}

/// BUS-ADDRESS.toml, as 'settings save --bus' calls it.
Result<GatewayFiles::Module> module_in(const fs::path& file, Output& output) {
  const auto name = file.stem().string();
  const auto dash = name.rfind('-');
  const auto address = parse_number<std::int32_t>(
      dash == name.npos ? std::string_view() : std::string_view(name).substr(dash + 1), 1,
      greatest_address);
  if (!address || dash == 0)
    return tl::unexpected(
        file_error(file, "is neither configuration.toml nor called BUS-ADDRESS.toml",
                   "'tmclctl settings save --bus NAME -o FOLDER' writes such files"));
  auto text = text_in(file);
  if (!text) return tl::unexpected(std::move(text.error()));
  if (const auto parsed = tmcld::parse_settings(*text); !parsed) {
    const auto& problems = parsed.error();
    return tl::unexpected(
        error_from(file.string(), problems, problems.size() + 1, output, "bad_settings"));
  }
  return GatewayFiles::Module{file.string(), name.substr(0, dash), *address, std::move(*text)};
}

Result<GatewayFiles> files_of_gateway(const fs::path& folder, Output& output) {
  GatewayFiles files;
  std::vector<fs::path> paths;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) paths.push_back(entry.path());
  if (failure) return tl::unexpected(file_error(folder, failure.message()));
  std::ranges::sort(paths);
  for (const auto& file : paths) {
    if (file.filename().string().starts_with('.') || file.extension() != ending_of_files) continue;
    if (file.filename() == configuration_file) {
      auto text = text_in(file);
      if (!text) return tl::unexpected(std::move(text.error()));
      files.configuration = std::move(*text);
    } else {
      auto module = module_in(file, output);
      if (!module) return tl::unexpected(std::move(module.error()));
      files.modules.push_back(std::move(*module));
    }
  }
  return files;
}

/// Of each gateway that is meant a folder of its name; other files are left alone.
Result<Files> read_folder(const std::string& folder, Fleet& fleet) {
  Files files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const auto name = entry.path().filename().string();
    if (!entry.is_directory() || name.starts_with('.') || !fleet.gateways.is_meant(name)) continue;
    auto read = files_of_gateway(entry.path(), fleet.output);
    if (!read) return tl::unexpected(std::move(read.error()));
    if (read->configuration || !read->modules.empty()) files.emplace(name, std::move(*read));
  }
  if (failure) return tl::unexpected(file_error(folder, failure.message()));
  if (!files.empty()) return files;
  return tl::unexpected(
      file_error(folder, "has no folder of a gateway that is meant",
                 "such as FOLDER/hall-1/configuration.toml and FOLDER/hall-1/bench-1.toml"));
}

// ---- one gateway --------------------------------------------------------------------------------

/// What is different on it, and made as its files say. Each error ends the roll-out.
class RolledOut {
 public:
  RolledOut(std::string name, const GatewayFiles& files, Fleet& fleet)
      : name_(std::move(name)), files_(files), fleet_(fleet) {}

  const std::string& name() const { return name_; }
  const json::object& differences() const { return differences_; }
  bool differs() const { return !differences_.empty(); }

  /// Reads, and changes nothing.
  Result<void> look() {
    differences_.clear();
    if (!fleet_.gateways.is_online(name_))
      return tl::unexpected(gateway_away(name_, tmcl::Outcome::not_sent));
    // Whether it hears this user, in that role, is known sooner than what modules have.
    if (const auto heard = call("nonce", {}, false); !heard) return tl::unexpected(heard.error());
    if (auto looked = look_at_configuration(); !looked) return looked;
    for (const auto& module : files_.modules)
      if (auto looked = look_at(module); !looked) return looked;
    return {};
  }
  void show() const {
    auto& out = fleet_.output.out;
    if (!differs()) out << name_ << ": as its files say\n";
    for (const auto& [file, lines] : differences_) {
      out << name_ << ' ' << std::string_view(file) << ":\n";
      for (const auto& line : lines.get_array())
        out << "  " << std::string_view(line.get_string()) << '\n';
    }
    out.flush();
  }
  /// All of its axes must stand and have no holder.
  Result<void> apply(bool store) {
    if (auto rests = see_all_rest(); !rests) return rests;
    if (differences_.contains(configuration_file)) {
      const json::object params{{"toml", *files_.configuration}};
      if (auto set = call("configuration.set", params, true, patience_with_modules); !set)
        return tl::unexpected(std::move(set.error()));
    }
    for (const auto& module : files_.modules) {
      if (!differences_.contains(name_of(module)) && !store) continue;
      if (auto loaded = load(module, store); !loaded) return loaded;
    }
    if (auto looked = look(); !looked) return looked;
    if (!differs()) return {};
    return tl::unexpected(surprise("it is not as its files say, although all was written"));
  }

 private:
  static std::string name_of(const GatewayFiles::Module& module) {
    return fs::path(module.file).filename().string();
  }
  Error surprise(std::string message) const {
    return {"not_applied", ErrorKind::failed, tmcl::Outcome::done, std::move(message),
            "'fleet apply --dry-run' shows what differs"};
  }

  Result<json::object> call(const std::string& method, json::object params, bool acts,
                            tmcl::Duration patience = CallRound::usual_patience) {
    std::optional<Result<json::object>> answer;
    const auto called = fleet_.call(
        "configure", {{name_, method, std::move(params), acts, {}}},
        [&](const FleetCall&, const Result<json::object>& result) { answer.emplace(result); },
        patience);
    if (!called) return tl::unexpected(called.error());
    return *answer;
  }

  Result<void> look_at_configuration() {
    if (!files_.configuration) return {};
    const auto got = call("configuration.get", {}, false);
    if (!got) return tl::unexpected(got.error());
    const auto lines = difference_of(text_at(*got, "toml"), *files_.configuration);
    if (lines.empty()) return {};
    const json::object params{{"toml", *files_.configuration}, {"dry_run", true}};
    // It changes nothing; but its effect is that of the method.
    if (const auto tried = call("configuration.set", params, true, patience_with_modules); !tried)
      return tl::unexpected(tried.error());
    differences_[configuration_file] = json::array(lines.begin(), lines.end());
    return {};
  }

  Result<void> look_at(const GatewayFiles::Module& module) {
    const json::object params{
        {"bus", module.bus}, {"address", module.address}, {"toml", module.toml}};
    const auto compared = call("settings.compare", params, false, patience_with_modules);
    if (!compared) return tl::unexpected(of_module(module, compared.error()));
    json::array lines;
    for (const auto& one : api::from_json<api::settings::Differences>(*compared).differences) {
      const auto present = one.present ? std::to_string(*one.present) : std::string("-");
      const auto line =
          fmt::format("{} {}: {} -> {}", one.section, one.parameter, present, one.wanted);
      if (is_printable(line)) lines.emplace_back(line);
    }
    if (!lines.empty()) differences_[name_of(module)] = std::move(lines);
    return {};
  }

  Result<void> load(const GatewayFiles::Module& module, bool store) {
    const json::object params{
        {"bus", module.bus}, {"address", module.address}, {"toml", module.toml}, {"store", store}};
    const auto answered = call("settings.load", params, true, patience_with_modules);
    if (!answered) return tl::unexpected(of_module(module, answered.error()));
    const auto loaded = api::from_json<api::settings::Loaded>(*answered);
    if (loaded.refused.empty() && loaded.differing.empty()) return {};
    return tl::unexpected(
        of_module(module, surprise(fmt::format("{} settings are refused, {} differ afterwards",
                                               loaded.refused.size(), loaded.differing.size()))));
  }

  static Error of_module(const GatewayFiles::Module& module, Error error) {
    error.message = name_of(module) + ": " + error.message;
    return error;
  }

  Result<void> see_all_rest() {
    for (const auto& axis : fleet_.gateways.all().at(name_).axes) {
      const auto got = call("axis.get_state", {{"axis", axis}}, false);
      if (!got) return tl::unexpected(got.error());
      const auto state = api::from_json<api::axis::State>(*got);
      if (!state.moving && !state.lease && !state.owner) continue;
      return tl::unexpected(
          Error{"in_use", ErrorKind::not_now, tmcl::Outcome::not_sent,
                fmt::format("axis {} {}", axis, state.moving ? "moves" : "has a holder"),
                "wait until it stands and is free; what was applied so far stays"});
    }
    return {};
  }

  std::string name_;
  const GatewayFiles& files_;
  Fleet& fleet_;
  json::object differences_;  ///< By file: lines.
};

// ---- all of them --------------------------------------------------------------------------------

Result<ExitCode> apply(const verb::FleetApply& verb, Fleet& fleet) {
  const auto files = read_folder(verb.folder, fleet);
  if (!files) return tl::unexpected(files.error());
  if (auto found = fleet.find(); !found) return tl::unexpected(found.error());
  FleetAnswers answers(fleet);
  std::vector<RolledOut> gateways;
  for (const auto& [name, of_gateway] : *files) gateways.emplace_back(name, of_gateway, fleet);
  auto worst = ExitCode::done;
  for (auto& gateway : gateways) {
    const auto looked = gateway.look();
    if (!looked && looked.error().kind == ErrorKind::interrupted)
      return tl::unexpected(looked.error());
    if (!looked) {
      worst = std::max(worst, exit_code_of(looked.error()));
      answers.fail(gateway.name(), looked.error());
      continue;
    }
    answers.document_of(gateway.name())["differences"] = gateway.differences();
    if (!fleet.output.json) gateway.show();
  }
  if (verb.dry_run) return answers.end();
  if (worst != ExitCode::done) {
    fleet.output.err << "tmclctl: nothing was changed on any gateway\n";
    return answers.end();
  }
  for (auto& gateway : gateways) {
    if (!gateway.differs() && !verb.store) continue;
    if (const auto applied = gateway.apply(verb.store); !applied) {
      answers.fail(gateway.name(), applied.error());
      fleet.output.err << "tmclctl: stopped at " << gateway.name()
                       << "; the gateways behind it were not changed\n";
      return answers.end();
    }
    answers.document_of(gateway.name())["applied"] = true;
    if (!fleet.output.json) fleet.output.out << gateway.name() << ": applied" << std::endl;
  }
  return answers.end();
}

constexpr const char* apply_help = R"(
Makes gateways as files say, which may lie in a git repository: FOLDER/GATEWAY/configuration.toml is what
tmcld keeps as 'managed' of its [daemon], with buses, modules and axes; FOLDER/GATEWAY/BUS-ADDRESS.toml are
the settings of a module, as 'settings save --bus' writes them.

First all gateways are looked at, and it is shown what differs. If a gateway is away, or a file is refused,
nothing is changed anywhere. Then one gateway after the other is made so, if all of its axes stand and no
client holds one, and is looked at again; what is not as expected ends it there. --dry-run only looks. It
needs the role configure.

  tmclctl --fleet mqtts://broker.example --cert anna.crt --key anna.key fleet apply machines --dry-run
  tmclctl --fleet mqtts://broker.example --cert anna.crt --key anna.key -g hall3-1 fleet apply machines
)";

}  // namespace

void add_fleet_apply(Grammar& grammar, const Form& group) {
  auto form = grammar.verb<verb::FleetApply>(group, "apply", access::fleet_only(VerbEffect::tells),
                                             "Make gateways as files say", apply_help, apply);
  form.word("FOLDER", "With a folder for each gateway", text(form->folder));
  form.flag("--dry-run", "Only show what differs", form->dry_run);
  form.flag("--store", "Keep settings in the EEPROM of the modules, too", form->store);
}

}  // namespace tmclctl
