/// The trials that tell what an axis bears, and the searches that they are made for.
#pragma once

#include <optional>
#include <string>

#include "tmcl/plan/limit_search.hpp"
#include "tmcl/plan/ramp_wish.hpp"
#include "tmcl/plan/ring_down.hpp"
#include "tmcl/tuning.hpp"
#include "tune/encoded_axis.hpp"
#include "tune/switched_axis.hpp"
#include "tune/trial_ramps.hpp"
#include "tune/tuned_parameters.hpp"

namespace tmcl::verbs {

class Tuner {
 public:
  Tuner(AxisAddress axis, TuneOptions options)
      : axis_(axis), options_(std::move(options)), watched_(axis, options_.settings) {}

  Script<Result<Tuning>> run();

 private:
  Script<Result<void>> course();
  Script<Result<void>> begin();
  Script<Result<void>> find_velocity();
  Script<Result<void>> find_acceleration();
  Script<Result<void>> find_current();
  Script<Result<void>> find_threshold();
  Script<Result<void>> find_bow();
  Script<Result<std::optional<double>>> swing_with(std::int32_t bow);
  Script<Result<void>> find_hold_current();
  Script<Result<std::optional<std::int32_t>>> least_hold_current();
  Script<Result<bool>> stands_with(std::int32_t current);
  Script<Result<void>> hold_at_once();
  Script<Result<void>> confirm();
  Script<Result<void>> search(Sought sought, plan::LimitSearch& search);
  Script<Result<bool>> trial(Sought sought, const plan::PlannedRamp& ramp, std::int32_t current,
                             std::int32_t way);
  Script<Result<void>> there_and_back(TuneTrial& trial, const plan::PlannedRamp& ramp,
                                      std::int32_t way);
  Script<Result<void>> out_and_back(TuneTrial& trial, const plan::PlannedRamp& ramp,
                                    std::int32_t way);
  Script<Result<void>> set_gentle();
  Script<Result<double>> find_switch(std::int32_t way);
  Script<Result<void>> calibrate();
  Script<Result<void>> calibrate_encoder();
  Script<Result<void>> calibrate_switch();
  Script<Result<void>> go_home();
  Script<Result<bool>> load_stays_up(std::int32_t threshold);
  Script<Result<void>> set_ramp(const plan::PlannedRamp& ramp);
  Script<Result<void>> recover(bool up, Duration limit);
  Script<Result<void>> go_slowly_to(std::int32_t target);

  const Model& model() const { return *options_.units.model; }
  std::int32_t present(std::uint8_t parameter) const { return ramps_.present(parameter); }
  bool has(std::uint8_t parameter) const {
    return find_parameter(axis_parameters(model()), parameter) != nullptr;
  }
  const ParameterInfo* row_of(std::string_view name) const;
  double greatest_acceleration() const;
  plan::RingDown ring_down_seen() const;
  std::int32_t current_for(Sought sought, double value) const;
  /// Where trials begin, and where they get to.
  std::int32_t base() const { return away_ > 0 ? range_.least : range_.greatest; }
  std::int32_t at(std::int32_t way) const { return base() + away_ * way; }
  Lookout lookout_of(const TuneTrial& trial, const plan::PlannedRamp& ramp, std::int32_t way) const;
  std::int32_t room() const { return range_.greatest - range_.least; }
  void propose();
  void tell(const std::string& what) const {
    if (options_.tell) options_.tell(what);
  }

  AxisAddress axis_;
  TuneOptions options_;
  WatchedAxis watched_;
  std::optional<EncodedAxis> encoded_;
  std::optional<SwitchedAxis> switched_;  ///< One of these two.
  int away_ = 1;                          ///< From the base: 1 up, -1 down.
  Tuning found_;
  TrialRamps ramps_{options_, found_};
  std::vector<ReadingAt> at_rest_;  ///< After the last move that was listened to.
  ValueRange range_{};
  plan::PlannedRamp slow_{};
  plan::PlannedRamp back_{};    ///< To go back with; it has held.
  bool beyond_bounds_ = false;  ///< In the search under way something was not in the module.
  bool beyond_travel_ = false;
};

}  // namespace tmcl::verbs
