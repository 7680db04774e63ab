// The tables of docs/PROTOCOL.md are those of the methods: TMCL_DRAW=1 writes them anew.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "api/method.hpp"
#include "support/build_paths.hpp"

namespace tmcld {
namespace {

constexpr std::string_view heading = "### ";
constexpr std::string_view of_params = "| parameter | type | |";
constexpr std::string_view of_result = "| result | type | |";
constexpr std::string_view of_roles = "| role | methods |";

std::string type_of(const api::Field& row, bool is_param) {
  using enum api::FieldType;
  std::string name(api::name_of(row.type));
  if (row.type == quantity) name = "[quantity](#quantities)";
  if (row.type == quantities) name = "array of [quantities](#quantities)";
  if (!is_param) return name + (row.required ? "" : " or null");
  const auto range = fmt::format("{}..{}", row.minimum, row.maximum);
  const api::Bounds all{};
  if (row.minimum == all.minimum && row.maximum == all.maximum) return name;
  if (row.type == integer) return range;
  if (row.type == integers) return "array of " + range;
  return row.type == text_or_integer ? "name or " + range : name;
}

void add_rows(std::string& table, std::span<const api::Field> rows, const std::string& within,
              bool is_param) {
  for (const auto& row : rows) {
    const auto name = within + std::string(row.name);
    table += fmt::format("| `{}` | {} | {}{} |\n", name, type_of(row, is_param),
                         is_param && row.required ? "required; " : "", row.summary);
    const auto* each = row.type == api::FieldType::objects ? "[]." : ".";
    // What a field of rpc.discover has for each field of an object is the same again.
    if (row.inner != nullptr && row.name != "members")
      add_rows(table, row.inner().rows, name + each, is_param);
  }
}

std::string tables_of(const MethodInfo& method) {
  std::string tables;
  for (const bool is_param : {true, false}) {
    const auto rows = is_param ? method.params : method.result;
    if (rows.empty()) continue;
    tables += fmt::format("{}\n| --- | --- | --- |\n", is_param ? of_params : of_result);
    add_rows(tables, rows, "", is_param);
    tables += '\n';
  }
  return tables;
}

std::string table_of_roles() {
  std::string table(of_roles);
  table += "\n| --- | --- |\n";
  for (const auto role : {Role::stop, Role::observe, Role::operate, Role::configure}) {
    std::string methods;
    for (const auto& method : method_table()) {
      if (method.role != role) continue;
      methods += fmt::format("{}`{}`", methods.empty() ? "" : ", ", method.name);
    }
    table += fmt::format("| `{}` | {} |\n", name_of(role), methods);
  }
  return table + '\n';
}

bool is_example(std::string_view line) {
  return line.starts_with("```jsonrpc") || line.starts_with("    >");
}

/// The page with other tables in the sections of methods: each before the section's examples.
std::string redrawn(std::istream& page) {
  std::string drawn;
  std::string waiting;
  bool in_old_table = false;
  for (std::string line; std::getline(page, line);) {
    if (line == of_params || line == of_result || line == of_roles) in_old_table = true;
    if (line == of_roles) drawn += table_of_roles();
    if (std::exchange(in_old_table, in_old_table && !line.empty())) continue;
    if (is_example(line) || line.starts_with("#")) drawn += std::exchange(waiting, {});
    if (line.starts_with(heading)) {
      const auto* method = find_method(std::string_view(line).substr(heading.size()));
      if (method != nullptr) waiting = tables_of(*method);
    }
    drawn += line + '\n';
  }
  return drawn;
}

TEST(ProtocolPage, HasTheTablesOfTheMethods) {
  const auto path = std::filesystem::path(TMCL_SOURCE_DIR) / "docs" / "PROTOCOL.md";
  std::ifstream file(path);
  const std::string kept{std::istreambuf_iterator<char>(file), {}};
  std::istringstream page(kept);
  const auto drawn = redrawn(page);
  if (std::getenv("TMCL_DRAW") != nullptr) {
    std::ofstream(path) << drawn;
    return;
  }
  EXPECT_TRUE(kept == drawn) << "docs/PROTOCOL.md is not what the methods are: TMCL_DRAW=1 writes "
                                "its tables anew";
  for (const auto& method : method_table())
    EXPECT_THAT(kept, testing::HasSubstr(fmt::format("{}{}\n", heading, method.name)));
}

}  // namespace
}  // namespace tmcld
