#include "gateway/axis/stop_advice.hpp"

#include <algorithm>
#include <array>

namespace tmcld {
namespace {

struct Advice {
  std::string_view cause;
  std::string_view text;
};

constexpr auto all_advice = std::to_array<Advice>({
    {"stall",
     "its stall detection took the load for a stall; accelerate less, give more current, or raise "
     "the threshold of the stall detection"},
    {"deviation",
     "its encoder is too far from its counter: the motor lost steps, or the encoder does not "
     "count; mend that, and search the reference again"},
    {"left_limit", "its left switch is closed; move to the other side, away from it"},
    {"right_limit", "its right switch is closed; move to the other side, away from it"},
    {"deadman",
     "its module stopped it, since no command came for longer than its deadman allows; see "
     "whether the computer or the bus was busy, or set a longer time"},
    {"supply",
     "its module has started again, and its position is lost; check the supply, then recover the "
     "axis and search the reference again"},
    {"client",
     "another program or user sent a stop, which the log of tmcld tells; move again when it is "
     "safe"},
    {"lease_lost",
     "the program that had the axis for itself has ended, or did not renew its lease in time; "
     "start it again when it is safe"},
    {"daemon",
     "tmcld stopped it, as a line, a path or a program with it ended early, or as a stop was "
     "still owed; the log of tmcld says why"},
    {"search_limit",
     "its reference search went further one way than it may; look at its switches and the mode of "
     "the search"},
    {"velocity_mode",
     "something that tmcld does not know of commands it: another host on the bus, or a program in "
     "its module; end that before it is moved again"},
    {"unknown",
     "its module does not say why; look at its flags and switches, and for another host on the "
     "bus, before it is moved again"},
});

}  // namespace

std::string_view advice_on(std::string_view cause) {
  const auto* found = std::ranges::find(all_advice, cause, &Advice::cause);
  return found == all_advice.end() ? std::string_view{} : found->text;
}

}  // namespace tmcld
