#include "grammar.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "tmcl/quantity.hpp"
#include "tmcl/ramp/resonant_load.hpp"

namespace tmclctl {
namespace {

/// `names`: of a word or of an option, the long one last.
void must_be_good(const Reading& reading, const std::string& names) {
  if (reading) return;
  const auto name = names.substr(names.rfind(',') + 1);
  throw CLI::ValidationError(fmt::format("{}: {}", name, reading.error()));
}

/// Stands for '=' in names that CLI11 knows: from version 2.4 on it refuses '=' there.
constexpr char equals_sign = '~';

std::string for_library(std::string name) {
  std::ranges::replace(name, '=', equals_sign);
  return name;
}

CLI::Option& add_one(CLI::App& app, const std::string& name, const std::string& value,
                     const std::string& description, const Read& read) {
  const auto checked = [read, name](const std::string& text) { must_be_good(read(text), name); };
  return *app.add_option_function<std::string>(for_library(name), checked, description)
              ->type_name(value);
}

CLI::Option& add_many(CLI::App& app, const std::string& name, const std::string& value,
                      const std::string& description, const Read& read) {
  const auto checked = [read, name](const std::vector<std::string>& texts) {
    for (const auto& text : texts) must_be_good(read(text), name);
  };
  return *app.add_option_function<std::vector<std::string>>(for_library(name), checked, description)
              ->type_name(value);
}

bool is_outermost(const CLI::App& verb) {
  return verb.get_parent() == nullptr || verb.get_parent()->get_parent() == nullptr;
}

}  // namespace

std::string name_of_word(const CLI::Option& word) {
  auto name = word.get_name(true);
  std::ranges::replace(name, equals_sign, '=');
  return name;
}

Read svg_file(std::string& into) {
  return [&into](const std::string& name) -> Reading {
    constexpr std::array<std::string_view, 11> others{
        ".png", ".jpg", ".jpeg", ".gif", ".bmp", ".tif", ".tiff", ".webp", ".pdf", ".eps", ".ps"};
    const std::filesystem::path path(name);
    auto ending = path.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
    if (std::ranges::find(others, ending) != others.end()) {
      auto drawn = path;
      return tl::unexpected(fmt::format("drawings are SVG, which '{}' does not say: give {}", name,
                                        drawn.replace_extension(".svg").string()));
    }
    into = name;
    return {};
  };
}

Read texts(std::vector<std::string>& into) {
  return [&into](const std::string& text) -> Reading {
    into.push_back(text);
    return {};
  };
}

Read list(std::vector<std::string>& into) {
  return [&into](const std::string& text) -> Reading {
    into.clear();
    for (std::size_t begin = 0; begin <= text.size();) {
      const auto end = std::min(text.find(',', begin), text.size());
      if (end > begin) into.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    if (into.empty()) return tl::unexpected("'" + text + "' names nothing");
    return {};
  };
}

Reading read_time(const std::string& text, double least_s, double greatest_s, double& seconds) {
  const auto quantity = tmcl::parse_quantity(text);
  if (!quantity) return tl::unexpected(quantity.error().message);
  if (!quantity->unit.empty() && quantity->unit != "s" && quantity->unit != "ms")
    return tl::unexpected(fmt::format("'{}' is no time in s or ms", text));
  const double said_s = quantity->number * (quantity->unit == "ms" ? 1e-3 : 1);
  if (said_s < least_s || said_s > greatest_s)
    return tl::unexpected(fmt::format("{} is not within {} s and {} s", text, least_s, greatest_s));
  seconds = said_s;
  return {};
}

Read resonance(std::optional<double>& hertz) {
  return [&hertz](std::string text) {
    if (text.ends_with("Hz")) text.resize(text.size() - 2);
    return parse_number<double>(text, tmcl::ramp::least_resonance_hz,
                                tmcl::ramp::greatest_resonance_hz)
        .map([&](double value) { hertz = value; });
  };
}

Read milliseconds(std::chrono::milliseconds& into) {
  constexpr int shortest_interval_ms = 10;
  constexpr int longest_interval_ms = 60'000;
  return [&into](const std::string& text) {
    return parse_number<int>(text, shortest_interval_ms, longest_interval_ms).map([&](int value) {
      into = std::chrono::milliseconds(value);
    });
  };
}

Read named_axes(std::vector<std::string>& into) {
  return [&into](const std::string& text) -> Reading {
    const auto equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
      return tl::unexpected(fmt::format("'{}' is no NAME=AXIS", text));
    into.push_back(text);
    return {};
  };
}

Read text(std::string& into) {
  return [&into](const std::string& text) -> Reading {
    into = text;
    return {};
  };
}

void Form::word(const std::string& name, const std::string& description, const Read& read) {
  add_one(*app_, name, "", description, read).required();
}
void Form::optional_word(const std::string& name, const std::string& description,
                         const Read& read) {
  add_one(*app_, name, "", description, read);
}
void Form::words(const std::string& name, const std::string& description, const Read& read) {
  add_many(*app_, name, "", description, read);
}
void Form::module(std::string& into) { word("MODULE", module_meaning, text(into)); }
void Form::axis(std::string& into) { word("AXIS", axis_meaning, text(into)); }
void Form::option(const std::string& name, const std::string& value, const std::string& description,
                  const Read& read) {
  add_one(*app_, name, value, description, read);
}
void Form::required_option(const std::string& name, const std::string& value,
                           const std::string& description, const Read& read) {
  add_one(*app_, name, value, description, read).required();
}
void Form::repeated_option(const std::string& name, const std::string& value,
                           const std::string& description, const Read& read) {
  add_many(*app_, name, value, description, read).allow_extra_args(false);
}
void Form::flag(const std::string& name, const std::string& description, bool& into) {
  app_->add_flag(name, into, description);
}

void Form::internal(bool& into) {
  flag("--internal", "Take and tell what the module counts in, even if the axis has a unit", into);
}

namespace {

CLI::App& add_subcommand(CLI::App& parent, const std::string& name, const std::string& description,
                         const std::string& footer) {
  auto* verb = parent.add_subcommand(name, description);
  verb->fallthrough();
  verb->group("Verbs");
  verb->footer(footer);
  return *verb;
}

/// For --help: through which doors it goes, in a sentence.
std::string doors_text(const Access& verb) {
  switch (verb.doors) {
    case Doors::both: return "Goes through tmcld, and straight on a bus with --direct.\n";
    case Doors::tmcld_only: return fmt::format("Goes through tmcld only: {}.\n", verb.reason);
    case Doors::fleet_only: return {};
    case Doors::offline: return fmt::format("Needs neither tmcld nor a bus: {}.\n", verb.reason);
  }
  return {};
}

}  // namespace

CLI::App& Grammar::add_verb(CLI::App& parent, const std::string& name, const Access& access,
                            const std::string& description, const char* footer) {
  auto& verb =
      add_subcommand(parent, name, description, fmt::format("{}\n{}", footer, doors_text(access)));
  verbs_[&verb].info = {access, full_name(verb)};
  order_.push_back(&verb);
  return verb;
}

void Grammar::add_fleet_door(CLI::App& app) {
  auto& info = verbs_.at(&app).info;
  info.in_fleet = true;
  app.footer(app.get_footer() + (info.doors == Doors::fleet_only
                                     ? "Goes through a broker, which --fleet names.\n"
                                     : "With --fleet on many gateways at once.\n"));
}

Form Grammar::group(const std::string& name, const std::string& description, const char* footer) {
  auto& app = add_subcommand(app_, name, description, footer);
  app.require_subcommand(1);
  return Form(app);
}

Verb Grammar::said(const CLI::App& verb, std::vector<std::string> command) const {
  const auto& entry = verbs_.at(&verb);
  if (entry.command != nullptr) *entry.command = std::move(command);
  return entry.said();
}

const VerbInfo* Grammar::info(const CLI::App& verb) const {
  const auto entry = verbs_.find(&verb);
  return entry != verbs_.end() ? &entry->second.info : nullptr;
}

std::vector<VerbInfo> Grammar::infos() const {
  std::vector<VerbInfo> infos;
  for (const auto* verb : order_) infos.push_back(verbs_.at(verb).info);
  return infos;
}

std::optional<Error> Grammar::objection(const CLI::App& verb, bool json) const {
  const auto entry = verbs_.find(&verb);
  if (entry == verbs_.end() || !entry->second.objection) return std::nullopt;
  const auto complaint = entry->second.objection(json);
  if (complaint.empty()) return std::nullopt;
  return usage_error("usage", fmt::format("{}: {}", full_name(verb), complaint),
                     entry->second.hint);
}

std::string full_name(const CLI::App& verb) {
  return is_outermost(verb) ? verb.get_name()
                            : full_name(*verb.get_parent()) + ' ' + verb.get_name();
}

}  // namespace tmclctl
