/// A path that has been planned and not yet been run: what was told of it is what is run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gateway/axis/axis.hpp"
#include "gateway/journey/path_words.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld {

struct PlannedPath {
  std::int32_t number = 0;  ///< By which it is run.
  tmcl::plan::PathRequest request;
  tmcl::plan::PathSource source;  ///< Its axes; the elements are in the course.
  std::vector<std::shared_ptr<GatewayAxis>> axes;
  std::vector<tmcl::plan::PathAxis> known;  ///< As they were when it was planned.
  tmcl::plan::Course course;
  PathWords words;   ///< As they were when it was planned.
  std::string name;  ///< What its client calls it; empty: nothing.
};

}  // namespace tmcld
