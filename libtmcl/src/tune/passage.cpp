#include "tune/passage.hpp"

#include <algorithm>
#include <cstdlib>

#include "engine/verb_steps.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::verbs {
namespace {

namespace ap = axis_parameter;

constexpr auto load_value = number_of("load_value");

}  // namespace

Script<Result<void>> look_at_load(WatchedAxis& watched, Passage& passage, std::int32_t from) {
  const auto before = co_await must(watched.get(ap::actual_velocity));
  const auto value = co_await must(watched.get(load_value));
  const auto after = co_await must(watched.get(ap::actual_velocity));
  // While it speeds up the load is another one.
  if (before != after || std::abs(before) < from) co_return Result<void>{};
  passage.load_value = std::min(passage.load_value.value_or(value), value);
  co_return Result<void>{};
}

}  // namespace tmcl::verbs
