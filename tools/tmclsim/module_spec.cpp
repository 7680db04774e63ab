#include "module_spec.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <string_view>

#include "number_text.hpp"
#include "tmcl/spelling.hpp"

namespace tmclsim {
namespace {

constexpr std::size_t address_count = 256;
using Taken = std::bitset<address_count>;

struct Parts {
  std::string_view model;
  std::optional<std::string_view> address;
};

Parts parts_of(std::string_view text) {
  const auto at = text.find('@');
  if (at == std::string_view::npos) return {text, std::nullopt};
  return {text.substr(0, at), text.substr(at + 1)};
}

std::optional<std::uint8_t> parse_address(std::string_view text) {
  const auto value = parse_number<std::uint8_t>(text);
  return value && *value >= 1 ? value : std::nullopt;
}

std::string no_such_model(std::string_view name) {
  std::vector<std::string_view> names;
  std::string list;
  for (const auto& model : tmcl::models()) {
    names.push_back(model.name);
    list += (list.empty() ? "" : ", ") + std::string(model.name);
  }
  return "there is no module '" + std::string(name) + "'." + tmcl::did_you_mean(name, names) +
         " It can be one of " + list + ".";
}

tl::expected<ModuleSpec, std::string> parse_one(std::string_view text, Taken& taken) {
  const auto parts = parts_of(text);
  const auto* model = tmcl::find_model(parts.model);
  if (model == nullptr) return tl::unexpected(no_such_model(parts.model));
  if (!parts.address) return ModuleSpec{model, tmcl::ModuleAddress{0}};
  const auto address = parse_address(*parts.address);
  if (!address) {
    return tl::unexpected("'" + std::string(*parts.address) + "' in '" + std::string(text) +
                          "' is not an address: they are 1 to 255.");
  }
  taken.set(*address);
  return ModuleSpec{model, tmcl::ModuleAddress{*address}};
}

bool assign_free_addresses(std::vector<ModuleSpec>& modules, Taken& taken) {
  std::size_t next = 1;
  for (auto& module : modules) {
    if (module.address != tmcl::ModuleAddress{0}) continue;
    while (next < address_count && taken.test(next)) ++next;
    if (next == address_count) return false;
    taken.set(next);
    module.address = tmcl::ModuleAddress{static_cast<std::uint16_t>(next)};
  }
  return true;
}

}  // namespace

tl::expected<std::vector<ModuleSpec>, std::string> parse_modules(
    const std::vector<std::string>& texts) {
  Taken taken;
  std::vector<ModuleSpec> modules;
  for (const auto& text : texts) {
    const auto module = parse_one(text, taken);
    if (!module) return tl::unexpected(module.error());
    modules.push_back(*module);
  }
  if (!assign_free_addresses(modules, taken)) {
    return tl::unexpected(
        std::string("there are more modules than addresses: at most 255 fit on a line."));
  }
  return modules;
}

std::vector<std::string> shared_addresses(const std::vector<ModuleSpec>& modules) {
  std::array<int, address_count> users{};
  for (const auto& module : modules) ++users[number(module.address)];
  std::vector<std::string> sentences;
  for (std::size_t address = 0; address < users.size(); ++address) {
    if (users[address] < 2) continue;
    sentences.push_back(std::to_string(users[address]) + " modules have the address " +
                        std::to_string(address) + " and will all answer to it.");
  }
  return sentences;
}

}  // namespace tmclsim
