#include "api/can_identifiers.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

namespace gp = tmcl::global_parameter;

bool is_of_a_module(const GatewayBus& bus, tmcl::ModuleAddress asked, std::int32_t identifier) {
  return identifier == number(asked) || std::ranges::any_of(bus.modules(), [&](const auto& module) {
           const bool is_known = module.second->is_configured() || module.second->identity();
           return is_known && identifier == number(module.first);
         });
}

}  // namespace

std::optional<Error> identifier_conflict(const GatewayBus& bus, const tmcl::Request& request) {
  constexpr std::uint8_t bank = 0;
  if (!bus.is_can() || request.command != tmcl::Command::SGP || request.motor != bank)
    return std::nullopt;
  const bool listens = request.type == gp::can_id || request.type == gp::can_secondary_address;
  const auto replies = static_cast<std::int32_t>(bus.config().link_options.can_reply_id);
  const bool to_replies = listens && request.value == replies;
  const bool to_module =
      request.type == gp::can_reply_id && is_of_a_module(bus, request.address, request.value);
  if (!to_replies && !to_module) return std::nullopt;
  const auto* whose = to_replies ? "the identifier of the replies" : "the address of a module";
  return param_error(
      "bad_argument", "value",
      fmt::format("{} is {} on bus '{}': a module whose address is that of the replies takes each "
                  "of them for a command, and moves",
                  request.value, whose, bus.name()),
      "choose a number that no module and no reply on this bus has");
}

bool has_address_of_replies(const GatewayBus& bus, tmcl::ModuleAddress module) {
  return bus.is_can() && number(module) == bus.config().link_options.can_reply_id;
}

}  // namespace tmcld
