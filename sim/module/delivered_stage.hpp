/// What is bolted to the motors of a module before anybody adds anything.
#pragma once

#include "sim/stage/stage.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {

/// A bare stage, or one with the encoder that is built into the module: those that have one tell
/// its angle.
inline StageSettings delivered_stage(const Model& model) {
  StageSettings stage;
  if (find_parameter(axis_parameters(model), number_of("absolute_encoder_value")) != nullptr) {
    stage.encoder = EncoderSettings{};
  }
  return stage;
}

}  // namespace tmcl::sim
