#include "case.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "support/build_paths.hpp"
#include "tmcl/assembler.hpp"

namespace tmcl::conformance {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr std::string_view arrow = "->";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string> words_of(std::string_view text, char separator) {
  std::vector<std::string> words;
  while (!trimmed(text).empty()) {
    const auto end = std::min(text.find(separator), text.size());
    const auto word = trimmed(text.substr(0, end));
    if (!word.empty() || separator == ',') words.emplace_back(word);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

/// Takes the word off the front of a line if it begins with it.
bool take(std::string_view& line, std::string_view word) {
  if (!line.starts_with(word)) return false;
  const auto rest = line.substr(word.size());
  if (!rest.empty() && rest[0] != ' ') return false;
  line = trimmed(rest);
  return true;
}

// Decimal, or with 0x in front.
std::int32_t number(std::string_view text) {
  const bool hex = text.starts_with("0x");
  const auto digits = text.substr(hex ? 2 : 0);
  std::int64_t value = 0;
  const auto parsed =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, hex ? 16 : 10);
  if (parsed.ec != std::errc{} || parsed.ptr != digits.data() + digits.size()) {
    throw std::runtime_error("'" + std::string(text) + "' is no number");
  }
  return static_cast<std::int32_t>(value);
}

std::uint8_t byte(std::string_view text) { return static_cast<std::uint8_t>(number(text)); }

Bytes hex_bytes(std::string_view text) {
  Bytes bytes;
  for (const auto& word : words_of(text, ' ')) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

milliseconds duration(std::string_view text) {
  const auto words = words_of(text, ' ');
  if (words.size() != 2) throw std::runtime_error("a time is written like 50 ms or 2 s");
  return milliseconds(number(words[0]) * (words[1] == "s" ? 1000 : 1));
}

void put(Request& request, Field field, const std::string& word) {
  switch (field) {
    case Field::type: {
      const auto type = parse_subtype(request.command, word);
      request.type = type ? *type : byte(word);
      return;
    }
    case Field::motor: request.motor = byte(word); return;
    case Field::value:
    case Field::address: request.value = number(word); return;
  }
}

constexpr Operand all_fields[] = {
    {Field::type, "type"}, {Field::motor, "motor"}, {Field::value, "value"}};

Request request_of(std::string_view text) {
  const auto end = std::min(text.find(' '), text.size());
  const auto command = parse_command(text.substr(0, end));
  if (!command) throw std::runtime_error("no command: " + std::string(text));
  Request request{ModuleAddress{1}, *command};
  const auto* info = find_command(static_cast<std::uint8_t>(*command));
  const std::span<const Operand> operands =
      info != nullptr && info->operands ? *info->operands : std::span<const Operand>(all_fields);
  const auto words = words_of(text.substr(end), ',');
  if (words.size() > operands.size()) {
    throw std::runtime_error("too many operands: " + std::string(text));
  }
  for (std::size_t i = 0; i < words.size(); ++i) put(request, operands[i].field, words[i]);
  return request;
}

Expected expected_of(std::string_view text) {
  Expected expected;
  if (take(text, "silence")) {
    expected.kind = Expected::Kind::silence;
  } else if (take(text, "text")) {
    expected.kind = Expected::Kind::text;
    expected.text = text;
  } else {
    const auto words = words_of(text, ' ');
    if (words.empty() || words.size() > 2) throw std::runtime_error("no status after ->");
    expected.status = number(words[0]);
    if (words.size() == 2) expected.value = number(words[1]);
  }
  return expected;
}

Ask ask_of(std::string_view line) {
  Ask ask;
  if (take(line, "until")) {
    const auto time = line.substr(0, line.find(' ', line.find(' ') + 1));
    ask.patience = duration(time);
    line = trimmed(line.substr(time.size()));
  }
  const auto at = line.find(arrow);
  if (at == std::string_view::npos) throw std::runtime_error("no ->: " + std::string(line));
  ask.request = request_of(trimmed(line.substr(0, at)));
  ask.expected = expected_of(trimmed(line.substr(at + arrow.size())));
  return ask;
}

RawExchange raw_of(std::string_view line) {
  const auto at = line.find(arrow);
  if (at == std::string_view::npos) throw std::runtime_error("no ->");
  return {hex_bytes(line.substr(0, at)), hex_bytes(line.substr(at + arrow.size()))};
}

program::Program assembled(const std::string& text) {
  const auto assembly = program::assemble(
      "case", [&](const std::string&) -> tl::expected<std::string, std::string> { return text; });
  if (!assembly) throw std::runtime_error(describe(assembly.error().front()));
  return assembly->program;
}

/// Reads one file.
class Reader {
 public:
  explicit Reader(const fs::path& path) : name_(path.stem().string()), file_(path) {}

  std::vector<Case> read() {
    std::string line;
    while (next(line)) {
      try {
        interpret(trimmed(line));
      } catch (const std::exception& error) {
        throw std::runtime_error(name_ + ".txt:" + std::to_string(number_) + ": " + error.what());
      }
    }
    return std::move(cases_);
  }

 private:
  bool next(std::string& line) {
    ++number_;
    return static_cast<bool>(std::getline(file_, line));
  }

  void interpret(std::string_view line) {
    if (line.empty() || line[0] == '#') return;
    if (take(line, "module")) {
      choose_models(line);
    } else if (take(line, "case")) {
      group_ = cases_.size();
      for (const auto* model : models_) {
        cases_.push_back({name_, std::string(line), number_, model, {}, {}, {}});
      }
    } else {
      if (cases_.empty()) throw std::runtime_error("this belongs to no case");
      interpret_in_case(line);
    }
  }

  void choose_models(std::string_view names) {
    models_.clear();
    for (const auto& name : words_of(names, ' ')) {
      models_.push_back(find_model(name));
      if (models_.back() == nullptr) throw std::runtime_error("no such module: " + name);
    }
  }

  void interpret_in_case(std::string_view line) {
    if (take(line, "stage")) {
      for (auto& one : group()) one.stage.emplace_back(line);
    } else if (take(line, "setting")) {
      for (auto& one : group()) one.settings.emplace_back(line);
    } else if (take(line, "raw")) {
      add(raw_of(line));
    } else if (take(line, "wait")) {
      add(Wait{duration(line)});
    } else if (take(line, "console")) {
      add(Console{std::string(line)});
    } else if (take(line, "restart")) {
      add(Restart{});
    } else if (take(line, "event")) {
      const auto words = words_of(line, ' ');
      add(Event{number(words.at(0)), number(words.at(1))});
    } else if (take(line, "program")) {
      add(Download{assembled(text_up_to_end())});
    } else if (take(line, "parameter")) {
      add_parameter(line);
    } else if (take(line, "reads")) {
      add_reading(line);
    } else {
      if (!take(line, "before")) take(line, "after");
      add(ask_of(line));
    }
  }

  /// The cases that stand as one in the file: the same on several modules.
  std::span<Case> group() { return std::span(cases_).subspan(group_); }

  void add(const decltype(Line::action)& action) {
    for (auto& one : group()) one.lines.push_back({number_, action});
  }
  void add(Command command, std::uint8_t type, std::uint8_t motor, std::int32_t value,
           Expected expected) {
    add(Ask{{ModuleAddress{1}, command, type, motor, value}, std::move(expected)});
  }

  std::string text_up_to_end() {
    std::string text;
    std::string line;
    while (next(line) && trimmed(line) != "end") text += line + '\n';
    return text;
  }

  // N, MOTOR default D takes A B ... refuses C D ...
  void add_parameter(std::string_view line) {
    const auto words = words_of(line, ' ');
    const auto type = byte(std::string_view(words.at(0)).substr(0, words.at(0).find(',')));
    const auto motor = byte(words.at(1));
    std::int32_t present = 0;
    std::string what;
    for (std::size_t i = 2; i < words.size(); ++i) {
      if (words[i] == "default" || words[i] == "takes" || words[i] == "refuses") {
        what = words[i];
        continue;
      }
      const auto value = number(words[i]);
      if (what == "takes") add(Command::SAP, type, motor, value, {.value = value});
      if (what == "refuses") add(Command::SAP, type, motor, value, {.status = 4, .value = value});
      if (what != "refuses") present = value;
      add(Command::GAP, type, motor, 0, {.value = present});
    }
  }

  // N, MOTOR VALUE
  void add_reading(std::string_view line) {
    const auto words = words_of(line, ' ');
    const auto type = byte(std::string_view(words.at(0)).substr(0, words.at(0).find(',')));
    const auto motor = byte(words.at(1));
    add(Command::SAP, type, motor, 1, {.status = 3, .value = 1});
    add(Command::GAP, type, motor, 0, {.value = number(words.at(2))});
  }

  std::string name_;
  std::ifstream file_;
  std::size_t number_ = 0;
  std::vector<const Model*> models_;
  std::vector<Case> cases_;
  std::size_t group_ = 0;
};

void put_sum(Bytes& bytes) {
  unsigned sum = 0;
  for (const auto b : bytes) sum += b;
  bytes.push_back(static_cast<std::uint8_t>(sum % 256));
}

void put_value(Bytes& bytes, std::int32_t value) {
  for (const int shift : {24, 16, 8, 0}) {
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> shift & 0xFFU));
  }
}

}  // namespace

std::vector<Case> load_cases() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(TMCL_SOURCE_DIR "/tests/conformance/cases")) {
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<Case> cases;
  for (const auto& file : files) std::ranges::move(Reader(file).read(), std::back_inserter(cases));
  return cases;
}

Bytes serial_bytes(const Request& request) {
  Bytes bytes{static_cast<std::uint8_t>(request.address),
              static_cast<std::uint8_t>(request.command), request.type, request.motor};
  put_value(bytes, request.value);
  put_sum(bytes);
  return bytes;
}

Bytes serial_bytes(int status, std::uint8_t command, std::int32_t value) {
  Bytes bytes{2, 1, static_cast<std::uint8_t>(status), command};
  put_value(bytes, value);
  put_sum(bytes);
  return bytes;
}

}  // namespace tmcl::conformance
