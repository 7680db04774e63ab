#include "plot/picture.hpp"

namespace tmclctl::plot {

Picture picture_of(const Recording& recording) {
  return {summary(recording),
          recording.time_unit,
          {position_curve(recording), velocity_curve(recording)},
          {}};
}

}  // namespace tmclctl::plot
