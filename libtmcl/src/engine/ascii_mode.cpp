// Modules that understand no datagrams any more, because a host has put them into ASCII mode.
//
// The bus never does that itself. But a motor of such a module must be stopped all the same: when a
// stop was not answered as often as it is sent, a line goes out that ends the mode, and then the
// stop again, behind a fence. Other modules on the line take the characters for the beginning of a
// datagram, which they drop when nothing follows. One in ASCII mode with another letter hears that
// the line is not for it.
#include "engine/bus_engine.hpp"
#include "tmcl/ascii.hpp"

namespace tmcl::engine {

std::string leaving_ascii_mode(ModuleAddress module) {
  return '\r' + ascii::to_line(ascii::Leave{module}).value_or("") + '\r';
}

bool BusEngine::is_worth_rescue(const Call& call) {
  const auto& address = call.request.address;
  return modules_.framing() == Framing::serial && call.is_stop() && !call.options.hold &&
         call.options.attempts != 1 && call.rescue == Call::Rescue::none &&
         ascii::letter_of(reply_byte(address)) && !modules_.with(address).custody.is_recording();
}

/// For the stops of a module that have gone out and were not answered.
void BusEngine::ask_for_rescue(ModuleAddress address) {
  queue().for_each([&](Call& call) {
    const bool is_of_it = reply_byte(call.request.address) == reply_byte(address);
    if (is_of_it && call.was_on_the_wire() && is_worth_rescue(call))
      call.rescue = Call::Rescue::due;
  });
}

/// The line has not gone out after all.
void BusEngine::ask_for_rescue_again(ModuleAddress address) {
  queue().for_each([&](Call& call) {
    const bool is_of_it = reply_byte(call.request.address) == reply_byte(address);
    if (is_of_it && call.rescue == Call::Rescue::tried) call.rescue = Call::Rescue::due;
  });
}

/// One line serves all stops of the module. Behind it the line is silent until the module can have
/// answered, and the others have dropped what they heard.
void BusEngine::start_leaving_ascii(const Call& next) {
  const auto address = next.request.address;
  scheduler_.on_turn(modules_.framing(), next);
  queue().for_each([&](Call& call) {
    const bool is_of_it = reply_byte(call.request.address) == reply_byte(address);
    if (is_of_it && call.rescue == Call::Rescue::due) call.rescue = Call::Rescue::tried;
  });
  InFlight line{{address, Command::ENTER_ASCII_MODE, 0, 0, 0}, {}, std::nullopt, 0};
  line.deadline = scheduler_.now() + wire_time_ + options_.telegram_pause + options_.quiet_time;
  line.leaves_ascii = true;
  put_in_flight(modules_.channel_to(address), std::move(line));
}

}  // namespace tmcl::engine
