#include "sim/wire/line.hpp"

#include "sim/bench.hpp"

namespace tmcl::sim {

Line::Line(Bench& bench) : bench_(&bench) { bench_->attach(*this); }

Line::~Line() { bench_->detach(*this); }

}  // namespace tmcl::sim
