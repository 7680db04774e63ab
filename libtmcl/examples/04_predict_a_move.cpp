// What a TMC429 will do with a move, before any motor turns: no module is needed for this.

#include <iostream>
#include <string_view>

#include "tmcl/ramp/tmc429.hpp"

using tmcl::ramp::Tmc429;

int main() {
  using Register = Tmc429::Register;
  const double ticks_per_second = Tmc429::ticks_per_second(16e6);

  Tmc429 axis;
  axis.write(Register::v_min, 1);
  axis.write(Register::v_max, 1000);
  axis.write(Register::a_max, 500);
  axis.write(Register::pulse_div, 2);
  axis.write(Register::ramp_div, 3);
  if (const auto written = axis.write(Register::x_target, 100'000); !written) {
    std::cerr << describe(written.error()) << '\n';
    return 1;
  }

  const auto arrival = tmcl::ramp::arrival(axis, tmcl::ramp::last_tick);
  if (!arrival) {
    std::cerr << "it never arrives\n";
    return 1;
  }
  std::cout << "arrives after " << static_cast<double>(*arrival) / ticks_per_second << " s\n";

  // A copy is another future: half way it is told to come back.
  auto other = axis;
  other.advance_to(*arrival / 2);
  std::cout << "half way it is at " << other.motion().position << '\n';
  other.write(Register::x_target, 0);
  std::string_view phase;
  while (!other.arrived()) {
    if (other.phase() != phase) {
      phase = other.phase();
      std::cout << "  " << static_cast<double>(other.tick()) / ticks_per_second << " s: " << phase
                << '\n';
    }
    other.advance_to(other.next_change());
  }
  std::cout << "and back after " << static_cast<double>(other.tick()) / ticks_per_second << " s\n";
}
