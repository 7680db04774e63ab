#include "gateway/authority/reach.hpp"

#include <limits>
#include <string>

#include "tmcl/reach.hpp"

namespace tmcld {
namespace {

tmcl::Reach reach_of(const GatewayBus& bus) {
  const auto& options = bus.config().bus_options;
  tmcl::Reach reach;
  reach.framing = bus.is_can() ? tmcl::Framing::can : tmcl::Framing::serial;
  reach.host_address = options.host_address;
  reach.can_reply_id = bus.config().link_options.can_reply_id;
  // The module needs some time of its own besides.
  reach.longest_pause = options.telegram_pause + options.reply_timeout / 2;
  return reach;
}

std::string way_to_do_it(tmcl::Command command) {
  switch (command) {
    case tmcl::Command::ENTER_ASCII_MODE:
      return "close tmcld, and use a program for terminals on the module's own port";
    case tmcl::Command::ENTER_BOOTLOADER: return "firmware.upload loads new firmware";
    case tmcl::Command::FACTORY_RESET: return "module.factory_reset does that";
    default: return "global.set does it when no motor of the module moves; the bus must follow";
  }
}

bool may_move(const GatewayBus& bus, tmcl::ModuleAddress module) {
  for (unsigned motor = 0; motor <= std::numeric_limits<std::uint8_t>::max(); ++motor)
    if (bus.motors().may_move({module, static_cast<std::uint8_t>(motor)})) return true;
  return false;
}

tmcl::Error refusal(const GatewayBus& bus, const tmcl::Request& request, std::string_view why,
                    std::string hint) {
  auto error =
      tmcl::not_sent(tmcl::Errc::not_permitted,
                     "module " + std::to_string(number(request.address)) + " " + std::string(why) +
                         ": nothing on bus '" + bus.name() + "' could stop its motors",
                     std::move(hint));
  error.bus = bus.name();
  error.request = request;
  return error;
}

}  // namespace

std::optional<tmcl::Error> loss_of_reach(const GatewayBus& bus, const tmcl::Request& request) {
  const auto why = tmcl::loss_of_reach(request, reach_of(bus));
  if (!why) return std::nullopt;
  return refusal(bus, request, *why, way_to_do_it(request.command));
}

std::optional<tmcl::Error> loss_by_program(const GatewayBus& bus, tmcl::ModuleAddress module,
                                           const tmcl::program::Program& program,
                                           std::size_t first_address) {
  for (std::size_t i = 0; i < program.size(); ++i) {
    const auto& line = program[i];
    auto loss = loss_of_reach(bus, {module, line.command, line.type, line.motor, line.value});
    if (!loss) continue;
    loss->message = std::string(name_of(line.command)) + " at address " +
                    std::to_string(first_address + i) + " of the program: " + loss->message;
    loss->hint = "leave this line out: " + loss->hint;
    return loss;
  }
  return std::nullopt;
}

std::optional<tmcl::Error> loss_of_moving_motor(const GatewayBus& bus,
                                                const tmcl::Request& request) {
  const auto why = tmcl::loss_of_reach(request, reach_of(bus));
  if (!why || !may_move(bus, request.address)) return std::nullopt;
  return refusal(bus, request, *why, "a motor of it may move: stop all of them first");
}

}  // namespace tmcld
