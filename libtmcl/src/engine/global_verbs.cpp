// Setting a global parameter, and the identifiers on CAN that must not be the same.
#include <array>
#include <span>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

namespace gp = global_parameter;

/// What a module listens to, and what replies come with: 0 as second identifier means none.
bool listens_to(std::uint8_t parameter, std::int32_t identifier) {
  return parameter == gp::can_id || (parameter == gp::can_secondary_address && identifier != 0);
}

Error takes_replies_for_commands(ModuleAddress module, std::int32_t identifier) {
  return bad_argument(
      fmt::format("{} would be the CAN identifier of module {} and of replies: a module takes what "
                  "comes with its own identifier for a command, and moves",
                  identifier, number(module)),
      "give the module another identifier (global parameter 71), or all modules of the bus another "
      "one for their replies (70) first");
}

/// Compares with what the module has as another parameter, if it has that.
Script<Result<bool>> has(ModuleAddress module, std::uint8_t parameter, std::int32_t identifier) {
  auto value = co_await ask({module, Command::GGP, parameter, 0, 0});
  if (value)
    co_return *value == identifier &&
        (parameter == gp::can_reply_id || listens_to(parameter, identifier));
  if (value.error().outcome == Outcome::refused) co_return false;
  value.error().outcome = Outcome::not_sent;
  co_return tl::unexpected(value.error());
}

/// Which parameters must have another value.
std::span<const std::uint8_t> opposites(std::uint8_t parameter, std::int32_t value) {
  static constexpr std::array replies{gp::can_reply_id};
  static constexpr std::array listening{gp::can_id, gp::can_secondary_address};
  if (listens_to(parameter, value)) return replies;
  if (parameter == gp::can_reply_id) return listening;
  return {};
}

Script<Result<void>> check_identifiers(ModuleAddress module, std::uint8_t parameter,
                                       std::int32_t value) {
  for (const auto other : opposites(parameter, value)) {
    const auto same = co_await must(has(module, other, value));
    if (same) co_return tl::unexpected(takes_replies_for_commands(module, value));
  }
  co_return Result<void>{};
}

}  // namespace

Script<Result<void>> set_global(ModuleAddress module, std::uint8_t bank, std::uint8_t parameter,
                                std::int32_t value) {
  if (bank == 0) co_await must(check_identifiers(module, parameter, value));
  co_return co_await act({module, Command::SGP, parameter, bank, value});
}

}  // namespace tmcl::verbs
