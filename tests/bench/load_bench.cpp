// What a load that swings behind a motor costs, and choosing a ramp for it:
//
//   sim/move/rigid      a simulated module makes a move of a second, read every 10 ms
//   sim/move/resonant   the same with a load that swings at 12 Hz; its cost should be at most twice
//                       that of the first
//   ramp/compare        all bows of a TMC457 for one move and one load: should take less than 50 ms
//   ring_down/800       finding a swing in 800 positions

#include <benchmark/benchmark.h>

#include <cmath>

#include "support/lone_module.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/plan/ring_down.hpp"

namespace {

using namespace tmcl;

constexpr std::uint16_t model = 1276;
constexpr std::uint8_t encoder_position = number_of(Family::sixpoint, "encoder_position");

void move(benchmark::State& state, std::optional<ramp::Resonance> resonance) {
  sim::StageSettings stage;
  stage.encoder = sim::EncoderSettings{4000, false};
  stage.resonance = resonance;
  test::LoneModule lone(model, stage);
  lone.ask(Command::SAP, axis_parameter::max_velocity, 60'000);
  lone.ask(Command::SAP, axis_parameter::max_acceleration, 700'000);
  lone.ask(Command::SAP, number_of("velocity_v1"), 0);
  std::int32_t target = 0;
  double axis_seconds = 0;
  for (auto _ : state) {
    target = target == 0 ? 60'000 : 0;
    lone.ask(Command::MVP, 0, target);
    for (int i = 0; i < 120; ++i) {
      lone.look_at(lone.clock.now() + std::chrono::milliseconds(10));
      benchmark::DoNotOptimize(lone.module.axis(0).get(encoder_position));
    }
    axis_seconds += 1.2;
  }
  state.counters["axis_seconds_per_second"] =
      benchmark::Counter(axis_seconds, benchmark::Counter::kIsRate);
}

void compare(benchmark::State& state) {
  const auto& of_tmc457 = *find_model("TMCM-142");
  const std::vector<plan::Setting> settings{
      {axis_parameter::max_velocity, 5'000'000}, {16, 24'624}, {17, 24'624}};
  const plan::LoadWish load{{12, 0.05}, 50};
  for (auto _ : state) {
    for (const auto& variant : plan::ramp_variants(of_tmc457, settings))
      benchmark::DoNotOptimize(plan::judge_variant(of_tmc457, settings, variant, {50'000}, load));
  }
}

void ring_down(benchmark::State& state) {
  std::vector<plan::PositionAt> positions;
  for (int i = 0; i < 800; ++i) {
    const double t = (i + 0.3 * std::sin(i * 7.0)) * 0.002;
    positions.push_back({t, std::round(100 * std::exp(-4 * t) * std::cos(75 * t))});
  }
  for (auto _ : state) benchmark::DoNotOptimize(plan::ring_down(positions));
}

const int loads_added = [] {
  benchmark::RegisterBenchmark("sim/move/rigid", [](benchmark::State& state) { move(state, {}); });
  benchmark::RegisterBenchmark("sim/move/resonant", [](benchmark::State& state) {
    move(state, ramp::Resonance{12, 0.05});
  });
  benchmark::RegisterBenchmark("ramp/compare", compare)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("ring_down/800", ring_down)->Unit(benchmark::kMillisecond);
  return 0;
}();

}  // namespace
