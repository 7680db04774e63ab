/// A bus with one module whose first two motors are axes in mm.
#pragma once

namespace tmcld::test {

inline constexpr auto cable_config = R"(
[daemon]
socket = "/none"
[[bus]]
name = "bench"
link = "serial:/dev/none@115200"
[[axis]]
name = "x"
bus = "bench"
address = 1
motor = 0
unit = "mm"
units_per_revolution = 5
[[axis]]
name = "y"
bus = "bench"
address = 1
motor = 1
unit = "mm"
units_per_revolution = 5
)";

}  // namespace tmcld::test
