// How long it takes to plan a movement along one axis:
//
//   plan/trapezoid               from rest to rest without jerk
//   plan/scurve                  from rest to rest
//   plan/scurve_state_to_state   between states that move and accelerate
//   plan/coordinated_6           six axes on a straight line, from rest to rest without jerk
//   plan/.../ruckig              the same movements through Ruckig, if it was found;
//                                `ours_to_ruckig`: the ratio of the times of both in the same run

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tmcl/plan/line.hpp"
#include "tmcl/plan/trajectory.hpp"

#ifdef TMCL_WITH_RUCKIG
#include <ruckig/ruckig.hpp>
#endif

namespace {

using namespace tmcl::plan;

struct Case {
  State start;
  State target;
  Limits limits;
};

constexpr std::size_t many = 4096;
constexpr std::uint64_t seed = 1;

// Of the sizes of one, which is what Ruckig wants.
template <class Make>
std::vector<Case> cases(Make make) {
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Case> all;
  while (all.size() < many) {
    Case c{{}, {between(-5, 5), 0, 0}, {}};
    const double acceleration = between(0.1, 2);
    c.limits = {between(0.1, 2), acceleration, acceleration, between(0.2, 4)};
    make(c, between);
    if (plan_move(c.start, c.target, c.limits)) all.push_back(c);
  }
  return all;
}

std::vector<Case> trapezoids() {
  return cases(
      [](Case& c, const auto&) { c.limits.jerk = std::numeric_limits<double>::infinity(); });
}

std::vector<Case> s_curves() {
  return cases([](Case&, const auto&) {});
}

std::vector<Case> states() {
  return cases([](Case& c, const auto& between) {
    for (auto* state : {&c.start, &c.target}) {
      state->velocity = between(-1, 1) * c.limits.velocity;
      state->acceleration = between(-1, 1) * c.limits.acceleration;
    }
  });
}

void ours(benchmark::State& run, std::vector<Case> (*make)()) {
  const auto all = make();
  std::size_t next = 0;
  for (auto _ : run) {
    const auto& c = all[next++ % many];
    benchmark::DoNotOptimize(plan_move(c.start, c.target, c.limits));
  }
}

// Each axis has its part of the speed and the acceleration that they share.
void six_axes(benchmark::State& run) {
  constexpr std::size_t axes = 6;
  const auto all = trapezoids();
  std::vector<Way> ways;
  for (const auto& c : all)
    ways.push_back({c.target.position, c.limits.velocity, c.limits.acceleration});
  std::size_t next = 0;
  for (auto _ : run) {
    const std::span line(&ways[next], axes);
    next = (next + axes) % (many - axes);
    const auto ramp = share_ramp(line);
    for (const auto& way : line) {
      const double part = std::abs(way.distance / line[ramp.longest].distance);
      const double acceleration = part * ramp.acceleration;
      benchmark::DoNotOptimize(
          plan_move({}, {way.distance, 0, 0}, {part * ramp.velocity, acceleration, acceleration}));
    }
  }
}

#ifdef TMCL_WITH_RUCKIG
ruckig::InputParameter<1> input(const Case& c) {
  ruckig::InputParameter<1> in;
  in.current_position = {c.start.position};
  in.current_velocity = {c.start.velocity};
  in.current_acceleration = {c.start.acceleration};
  in.target_position = {c.target.position};
  in.target_velocity = {c.target.velocity};
  in.target_acceleration = {c.target.acceleration};
  in.max_velocity = {c.limits.velocity};
  in.max_acceleration = {c.limits.acceleration};
  in.max_jerk = {c.limits.jerk};
  return in;
}

// The quickest of a few, so that what else the machine does counts less.
double seconds(const auto& work) {
  using Clock = std::chrono::steady_clock;
  auto best = Clock::duration::max();
  for (int round = 0; round < 10; ++round) {
    const auto begin = Clock::now();
    for (std::size_t i = 0; i < many; ++i) work(i);
    best = std::min(best, Clock::now() - begin);
  }
  return std::chrono::duration<double>(best).count();
}

void theirs(benchmark::State& run, std::vector<Case> (*make)()) {
  const auto all = make();
  std::vector<ruckig::InputParameter<1>> inputs;
  for (const auto& c : all) inputs.push_back(input(c));
  ruckig::Ruckig<1> planner;
  ruckig::Trajectory<1> trajectory;
  const auto plan = [&](std::size_t i) {
    benchmark::DoNotOptimize(planner.calculate(inputs[i], trajectory));
    benchmark::DoNotOptimize(trajectory);
  };
  std::size_t next = 0;
  for (auto _ : run) plan(next++ % many);
  const double own = seconds([&](std::size_t i) {
    benchmark::DoNotOptimize(plan_move(all[i].start, all[i].target, all[i].limits));
  });
  run.counters["ours_to_ruckig"] = own / seconds(plan);
}
#endif

BENCHMARK(six_axes)->Name("plan/coordinated_6");

[[maybe_unused]] const bool registered = [] {
  using Make = std::vector<Case> (*)();
  for (const auto& [name, make] : {std::pair<std::string, Make>{"plan/trapezoid", trapezoids},
                                   {"plan/scurve", s_curves},
                                   {"plan/scurve_state_to_state", states}}) {
    benchmark::RegisterBenchmark(name.c_str(), ours, make);
#ifdef TMCL_WITH_RUCKIG
    benchmark::RegisterBenchmark((name + "/ruckig").c_str(), theirs, make);
#endif
  }
  return true;
}();

}  // namespace
