/// The reference search of an axis.
#pragma once

#include "sim/module/axis_encoders.hpp"
#include "sim/module/homing.hpp"

namespace tmcl::sim {

class AxisSearch {
 public:
  AxisSearch(AxisState& axis, AxisEncoders& encoders) : axis_(axis), encoders_(encoders) {}

  /// As parameter 193 says; nothing if it has no such mode.
  std::optional<SearchMode> mode() const;
  void start(const SearchMode& mode);
  void abort() { homing_.abort(); }
  void run();
  const Homing& homing() const { return homing_; }

 private:
  void obey(const Homing::Order& order);
  void drive(int direction, std::uint8_t speed_parameter);
  void finish(std::int32_t reference);

  AxisState& axis_;
  AxisEncoders& encoders_;
  Homing homing_;
};

}  // namespace tmcl::sim
