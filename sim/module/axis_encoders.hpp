/// The encoders of an axis, and whether its motor is where they say.
#pragma once

#include "sim/module/axis_state.hpp"
#include "sim/module/encoder_watch.hpp"

namespace tmcl::sim {

class AxisEncoders {
 public:
  explicit AxisEncoders(AxisState& axis) : axis_(axis) {}

  EncoderWatch& own() { return own_; }
  EncoderWatch& external() { return external_; }
  std::int32_t own_position() const { return position(own_); }
  std::int32_t external_position() const { return position(external_); }
  /// Calls the present position 0.
  void zero() {
    own_.set_position(0, axis_.coupling.stage());
    external_.set_position(0, axis_.coupling.stage());
  }
  void rescale();
  bool are_watched() const { return own_.is_on() || external_.is_on(); }
  bool are_exceeded() const {
    return own_.is_exceeded_by(deviation(own_)) || external_.is_exceeded_by(deviation(external_));
  }
  /// Shortens the reach to what the motor can go before they have to be looked at again.
  void limit(Reach& reach) const;

 private:
  std::int32_t position(const EncoderWatch& encoder) const {
    return static_cast<std::int32_t>(encoder.position(axis_.coupling.stage()));
  }
  EncoderScale scale_by(std::uint8_t parameter) const;
  std::int64_t deviation(const EncoderWatch& encoder) const;

  AxisState& axis_;
  EncoderWatch own_;
  EncoderWatch external_;
};

}  // namespace tmcl::sim
