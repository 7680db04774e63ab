/// How a generator names its registers in what it finds.
#pragma once

#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

template <class Register>
Finding::Mention mention(Register name, std::int64_t value, Finding::Form form) {
  return {static_cast<std::size_t>(name), value, form};
}
/// The register and what it holds.
template <class G>
Finding::Mention held(const G& generator, typename G::Register name) {
  return mention(name, generator.read(name), Finding::Form::name_and_value);
}

}  // namespace tmcl::ramp
