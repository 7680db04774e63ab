/// One motor of a module and its axis parameters.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include <tl/expected.hpp>

#include "sim/module/motor.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

class Axis {
 public:
  Axis(const Model& model, TimePoint power_on);

  /// What GAP answers: wrong_type for a number that is not in the model's table.
  tl::expected<std::int32_t, Status> get(std::uint8_t number) const;
  /// What SAP answers: wrong_type for a number that cannot be written, invalid_value out of range.
  Status set(std::uint8_t number, std::int32_t value);

  /// What ROR answers, or ROL with the other sign: invalid_value for more than the chip can do.
  Status rotate(std::int64_t velocity);
  void stop();
  /// Whether the chip has such a position.
  bool is_position(std::int32_t value) const;
  /// What MVP ABS answers: invalid_value for a position that the chip does not have.
  Status move_to(std::int32_t position);
  /// What MVP REL answers, likewise for a distance. The target wraps as the chip's positions do.
  Status move_by(std::int32_t distance);

  /// Lets time pass, no further than next_due().
  void advance_to(TimePoint time);
  /// When run_due() has something to do if no command comes before.
  TimePoint next_due() const { return outlook_.look_again; }
  void run_due();
  /// What becomes of the present movement.
  const Outlook& outlook() const { return outlook_; }

 private:
  void move(std::int64_t position);
  void look_ahead() { outlook_ = motor_->outlook(); }

  std::span<const ParameterInfo> table_;
  std::unique_ptr<Motor> motor_;
  std::array<std::int32_t, 256> values_{};  // of those parameters that the motor has no part in
  TimePoint now_;
  Outlook outlook_;
};

}  // namespace tmcl::sim
