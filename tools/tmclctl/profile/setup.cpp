#include "profile/setup.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tmcl/plain_number.hpp"
#include "tmcl/spelling.hpp"

namespace tmclctl::profile {
namespace {

using tmcl::ramp::RegisterInfo;

// "0x" and a sign are understood; nothing but digits may follow.
std::from_chars_result read_integer(std::string_view text, std::int64_t& value) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  std::uint64_t magnitude = 0;
  auto read =
      std::from_chars(text.data(), text.data() + text.size(), magnitude, hexadecimal ? 16 : 10);
  if (read.ptr != text.data() + text.size()) read.ec = std::errc::invalid_argument;
  if (read.ec == std::errc{} && magnitude > INT64_MAX) read.ec = std::errc::result_out_of_range;
  value = static_cast<std::int64_t>(negative ? -magnitude : magnitude);
  return read;
}

/// "Did you mean 'a'? There are a, b"
std::string choice(std::string_view word, const std::vector<std::string_view>& names) {
  auto question = tmcl::did_you_mean(word, names);
  if (!question.empty()) question = question.substr(1) + ' ';
  return fmt::format("{}There are {}", question, fmt::join(names, ", "));
}

struct Assignment {
  std::string_view name;
  std::string_view value;
};

Result<Assignment> split(std::string_view words) {
  const auto equals = words.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    return tl::unexpected(usage_error("bad_register",
                                      fmt::format("'{}' is no REGISTER=VALUE", words),
                                      "Such as v_max=1000; values may be written 0x3E8, too"));
  }
  return Assignment{words.substr(0, equals), words.substr(equals + 1)};
}

/// Turns words into what is written to the registers of one generator.
class SetupReader {
 public:
  explicit SetupReader(const GeneratorInfo& generator) : generator_(generator) {}

  Result<Write> read_write(const std::string& words) const {
    const auto assignment = split(words);
    if (!assignment) return tl::unexpected(assignment.error());
    const auto index = tmcl::ramp::find_register(generator_.registers, assignment->name);
    if (!index) return tl::unexpected(unknown_register(assignment->name));
    const auto value = read_value(words, generator_.registers[*index], assignment->value);
    if (!value) return tl::unexpected(value.error());
    return Write{*index, *value, words};
  }

 private:
  Result<std::int64_t> read_value(const std::string& words, const RegisterInfo& info,
                                  std::string_view text) const {
    if (const auto named = info.value_of(text)) return *named;
    std::int64_t value = 0;
    const auto problem = read_integer(text, value).ec;
    if (problem == std::errc{}) return value;
    if (const auto* scale = generator_.scale_of(info.name)) {
      double number = 0;
      const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
      const bool is_number = read.ec == std::errc{} && read.ptr == text.data() + text.size();
      const bool fits =
          number >= scale->in_unit(info.minimum) && number <= scale->in_unit(info.maximum);
      if (is_number && fits) return scale->in_register(number);
      if (is_number) return tl::unexpected(beyond(words, info, *scale));
    }
    const auto what =
        problem == std::errc::result_out_of_range
            ? fmt::format("{} is {}..{}, not {}", info.name, info.minimum, info.maximum, text)
            : fmt::format("'{}' is no whole number", text);
    return tl::unexpected(usage_error("bad_register", fmt::format("{}: {}", words, what),
                                      names_of_values(info, text)));
  }

  static Error beyond(const std::string& words, const RegisterInfo& info, const Scale& scale) {
    return usage_error(
        "bad_register",
        fmt::format("{}: {} is {}..{} {}", words, info.name,
                    tmcl::plain_number(scale.in_unit(info.minimum), 10),
                    tmcl::plain_number(scale.in_unit(info.maximum), 10), scale.unit));
  }

  static std::string names_of_values(const RegisterInfo& info, std::string_view text) {
    std::vector<std::string_view> names(info.names.begin(), info.names.end());
    std::erase(names, "");
    return names.empty() ? std::string{} : choice(text, names);
  }

  Error unknown_register(std::string_view name) const {
    std::vector<std::string_view> names;
    for (const auto& info : generator_.registers) names.push_back(info.name);
    if (generator_.clocked) names.push_back(clock_name);
    return usage_error("unknown_register",
                       fmt::format("{} has no register '{}'", generator_.name, name),
                       choice(name, names));
  }

  const GeneratorInfo& generator_;
};

bool is_clock(const std::string& words) {
  return words.starts_with(fmt::format("{}=", clock_name));
}

Result<double> read_clock(const std::string& words) {
  const auto text = std::string_view(words).substr(clock_name.size() + 1);
  double hz = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), hz);
  const bool number = read.ec == std::errc{} && read.ptr == text.data() + text.size();
  if (number && hz >= least_clock_hz && hz <= greatest_clock_hz) return hz;
  return tl::unexpected(
      usage_error("bad_register", fmt::format("{}: {} is a number of Hz within {} to {}", words,
                                              clock_name, least_clock_hz, greatest_clock_hz)));
}

Error given_twice(std::string_view name) {
  return usage_error("bad_register", fmt::format("{} is given twice", name),
                     "--change writes a register again later");
}

/// Takes it out of the settings, if it is there.
Result<double> take_clock(std::vector<std::string>& settings) {
  const auto others = std::stable_partition(settings.begin(), settings.end(), is_clock);
  const std::vector<std::string> given(settings.begin(), others);
  settings.erase(settings.begin(), others);
  if (given.size() > 1) return tl::unexpected(given_twice(clock_name));
  return given.empty() ? usual_clock_hz : read_clock(given.front());
}

const Write* find_write(const GeneratorInfo& generator, const std::vector<Write>& writes,
                        std::string_view name) {
  const auto found = std::ranges::find_if(
      writes, [&](const Write& write) { return generator.registers[write.index].name == name; });
  return found != writes.end() ? &*found : nullptr;
}

void add_defaults(const GeneratorInfo& generator, std::vector<Write>& writes) {
  for (const auto& row : generator.defaults) {
    if (find_write(generator, writes, row.register_name) != nullptr) continue;
    const auto* other = find_write(generator, writes, row.at_least);
    const auto value = other != nullptr ? std::max(row.value, other->value) : row.value;
    writes.push_back({*tmcl::ramp::find_register(generator.registers, row.register_name), value,
                      fmt::format("{}={}", row.register_name, value)});
  }
}

void put_in_order(const GeneratorInfo& generator, std::vector<Write>& writes) {
  std::ranges::stable_sort(writes, {}, [&](const Write& write) {
    const auto& last = generator.written_last;
    const auto place = std::ranges::find(last, generator.registers[write.index].name);
    return place == last.end() ? -1 : place - last.begin();
  });
}

Result<std::vector<Write>> read_start(const GeneratorInfo& generator,
                                      const std::vector<std::string>& settings) {
  std::vector<Write> writes;
  for (const auto& words : settings) {
    auto write = SetupReader(generator).read_write(words);
    if (!write) return tl::unexpected(write.error());
    const auto name = generator.registers[write->index].name;
    if (find_write(generator, writes, name) != nullptr) return tl::unexpected(given_twice(name));
    writes.push_back(std::move(*write));
  }
  add_defaults(generator, writes);
  put_in_order(generator, writes);
  return writes;
}

Result<std::vector<Change>> read_changes(const Setup& setup, const verb::Simulate& verb) {
  auto by_time = verb.changes;
  std::ranges::stable_sort(by_time, {}, &verb::Simulate::Change::time);
  std::vector<Change> changes;
  for (const auto& change : by_time) {
    if (setup.generator.clocked && is_clock(change.setting)) {
      return tl::unexpected(
          usage_error("bad_register",
                      fmt::format("{}: {} is the same all the time", change.setting, clock_name)));
    }
    auto write = SetupReader(setup.generator).read_write(change.setting);
    if (!write) return tl::unexpected(write.error());
    write->words = fmt::format("--change {}:{}", change.time, change.setting);
    changes.push_back({setup.tick_at(change.time), std::move(*write)});
  }
  return changes;
}

}  // namespace

Tick Setup::tick_at(double time) const {
  // What is meant to be a whole number of ticks may have become a little less.
  constexpr double rounding = 1e-6;
  return static_cast<Tick>(std::floor(time * ticks_per_second + rounding));
}

Result<const GeneratorInfo*> find_generator(std::string_view name) {
  std::vector<std::string_view> names;
  for (const auto& generator : generators()) {
    if (generator.name == name) return &generator;
    names.push_back(generator.name);
  }
  return tl::unexpected(usage_error(
      "unknown_generator", fmt::format("there is no generator '{}'", name), choice(name, names)));
}

Result<Setup> read_setup(const verb::Simulate& verb) {
  const auto generator = find_generator(verb.generator);
  if (!generator) return tl::unexpected(generator.error());
  auto settings = verb.settings;
  const auto clock_hz =
      (*generator)->clocked ? take_clock(settings) : Result<double>(usual_clock_hz);
  if (!clock_hz) return tl::unexpected(clock_hz.error());
  Setup setup{**generator, (*generator)->ticks_per_second(*clock_hz), {}};
  auto start = read_start(**generator, settings);
  if (!start) return tl::unexpected(start.error());
  setup.script.start = std::move(*start);
  auto changes = read_changes(setup, verb);
  if (!changes) return tl::unexpected(changes.error());
  setup.script.changes = std::move(*changes);
  return setup;
}

}  // namespace tmclctl::profile
