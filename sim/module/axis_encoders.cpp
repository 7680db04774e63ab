#include "sim/module/axis_encoders.hpp"

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {

void AxisEncoders::rescale() {
  own_.set_scale(scale_by(number_of("encoder_resolution")));
  external_.set_scale(scale_by(number_of("external_encoder_resolution")));
}

// With a prescaler, a count is worth so many 512ths of a microstep (manuals of the TMCM-1161 and
// PD-1160); with a resolution, a turn has so many counts. What was never set fits the encoder.
EncoderScale AxisEncoders::scale_by(std::uint8_t parameter) const {
  const auto* row = find_parameter(axis_.table, parameter);
  const auto value = row == nullptr ? 0 : axis_.values[parameter];
  const bool is_prescaler =
      axis_.family == Family::tmc429 || (row != nullptr && row->name.ends_with("_prescaler"));
  const bool is_resolution = row != nullptr && row->name.ends_with("_resolution");
  if (value != 0 && is_prescaler) return {value, 512};
  if (value != 0 && is_resolution) return {axis_.coupling.microsteps(), value};
  const auto& encoder = axis_.coupling.stage().settings().encoder;
  return {axis_.coupling.microsteps(), encoder ? encoder->counts_per_turn : 1};
}

std::int64_t AxisEncoders::deviation(const EncoderWatch& encoder) const {
  const auto counted = static_cast<std::int32_t>(encoder.position(axis_.coupling.stage()));
  return way_between(counted, axis_.motor->position(), axis_.motor->position_bits());
}

void AxisEncoders::limit(Reach& reach) const {
  for (const auto* encoder : {&own_, &external_}) {
    if (encoder->is_on()) encoder->limit(reach, deviation(*encoder), axis_.coupling);
  }
}

}  // namespace tmcl::sim
