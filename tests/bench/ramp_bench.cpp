// How much motion a second of computing time buys, in seconds of one axis:
//
//   ramp/<generator>/ticked              tick by tick, with the reference of the tests
//   ramp/<generator>/phased/end          whole moves, asked for the state once, at their end
//   ramp/<generator>/phased/polled_1khz  the same moves, asked every millisecond
//   ramp/<generator>/phased/cruising     asked every millisecond at a steady speed
//   ramp/<generator>/fleet               6,000 axes always on a move, each asked every 10 ms

#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "support/plain_sixpoint.hpp"
#include "support/plain_tmc429.hpp"
#include "support/plain_track.hpp"
#include "tmcl/ramp/mc1451a.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace {

using namespace tmcl;
using ramp::Tick;

constexpr double clock_hz = 16e6;

/// What the cases need to know of a generator. The settings are ordinary ones, with which a move
/// takes a second or two.
template <class G>
struct Axis;

template <>
struct Axis<ramp::Tmc429> {
  using G = ramp::Tmc429;
  using R = G::Register;

  // What a TMCM-1110 starts with.
  static G make() {
    G axis;
    axis.write(R::v_min, 1);
    axis.write(R::v_max, 1000);
    axis.write(R::a_max, 500);
    axis.write(R::pulse_div, 2);
    axis.write(R::ramp_div, 3);
    return axis;
  }
  static void go(G& axis, std::int32_t target) { axis.write(R::x_target, target); }
  static void cruise(G& axis) {
    axis.write(G::Mode::velocity);
    axis.write(R::v_target, 1000);
  }
  static void tick_to(const G& axis, Tick end) {
    test::PlainTmc429 plain;
    plain.v_min = 1;
    plain.v_max = 1000;
    plain.a_max = 500;
    plain.pd = 2;
    plain.rd = 3;
    plain.update_factor();
    plain.x = axis.x_actual();
    plain.xt = axis.x_target();
    plain.n = axis.tick();
    plain.advance_to(end);
    benchmark::DoNotOptimize(plain);
  }
};

template <>
struct Axis<ramp::SixPoint> {
  using G = ramp::SixPoint;
  using R = G::Register;

  static G make() {
    G axis;
    axis.write(R::vmax, 64'000);  // 61,000 microsteps/s at 16 MHz
    axis.write(R::amax, 6'000);   // 700,000 microsteps/s^2
    axis.write(R::dmax, 6'000);
    axis.write(R::d1, 6'000);
    axis.write(R::vstop, 10);
    return axis;
  }
  static void go(G& axis, std::int32_t target) { axis.write(R::xtarget, target); }
  static void cruise(G& axis) {
    axis.write(R::rampmode, static_cast<std::int64_t>(G::Mode::velocity_positive));
  }
  static void tick_to(const G& axis, Tick end) {
    test::PlainSixPoint plain;
    plain.vmax = 64'000;
    plain.amax = plain.dmax = plain.d1 = 6'000;
    plain.x = axis.motion().position * test::PlainSixPoint::microstep;
    plain.xtarget = axis.read(R::xtarget);
    for (auto tick = axis.tick(); tick < end; ++tick) plain.tick();
    benchmark::DoNotOptimize(plain);
  }
};

/// The reference of the generators with limited jerk adds up what they planned.
template <class G>
void add_up(const G& axis, Tick end) {
  test::PlainTrack<G> plain(axis);
  plain.advance_to(end, 1e9);
  benchmark::DoNotOptimize(plain.state());
}

template <>
struct Axis<ramp::Tmc457> {
  using G = ramp::Tmc457;
  using R = G::Register;

  static G make() {
    G axis;
    axis.write(R::v_max, 4'096'000);  // 61,000 microsteps/s at 16 MHz
    axis.write(R::a_max, 12'000);     // 700,000 microsteps/s^2
    axis.write(R::d_max, 12'000);
    axis.write(R::bow_max, 10);
    return axis;
  }
  static void go(G& axis, std::int32_t target) { axis.write(R::x_target, target); }
  static void cruise(G& axis) {
    axis.write(R::mode, 2);
    axis.write(R::v_target, 4'096'000);
  }
  static void tick_to(const G& axis, Tick end) { add_up(axis, end); }
};

template <>
struct Axis<ramp::Tmc4361> {
  using G = ramp::Tmc4361;
  using R = G::Register;

  static G make() {
    G axis;
    axis.write(R::vmax, 61'000 * 256);
    axis.write(R::amax, 700'000 * 4);
    axis.write(R::dmax, 500'000 * 4);
    axis.write(R::bow1, 8'000'000);
    axis.write(R::bow2, 12'000'000);
    axis.write(R::bow3, 10'000'000);
    axis.write(R::bow4, 6'000'000);
    return axis;
  }
  static void go(G& axis, std::int32_t target) { axis.write(R::xtarget, target); }
  static void cruise(G& axis) { axis.write(G::Mode::velocity); }
  static void tick_to(const G& axis, Tick end) { add_up(axis, end); }
};

template <>
struct Axis<ramp::Mc1451a> {
  using G = ramp::Mc1451a;
  using R = G::Register;

  // With cycles of 1/1000 s.
  static G make() {
    G axis;
    axis.write(R::velocity, 61 << 16);
    axis.write(R::acceleration, 32'767);
    axis.write(R::jerk, 1 << 28);
    return axis;
  }
  static void go(G& axis, std::int32_t target) { axis.write(R::position, target); }
  static void cruise(G& axis) { axis.write(R::position, 1 << 29); }
  static void tick_to(const G& axis, Tick end) { add_up(axis, end); }
};

/// A cycle of the MC1451A counts as a millisecond.
template <class G>
const double ticks_per_second = G::ticks_per_second(clock_hz) *
                                (std::is_same_v<G, ramp::Mc1451a> ? 1000 : 1);
template <class G>
const Tick millisecond = static_cast<Tick>(ticks_per_second<G> / 1000);

void report(benchmark::State& state, double axis_seconds) {
  state.counters["axis_seconds_per_second"] =
      benchmark::Counter(axis_seconds, benchmark::Counter::kIsRate);
}

/// Moves of about 100,000 microsteps to and fro; the same ones in every case.
template <class G>
class Moves {
 public:
  G axis = Axis<G>::make();

  /// Begins the next one, and says when it ends.
  Tick begin() {
    Axis<G>::go(axis, (forth_ ? 100'000 : 0) + place_(random_));
    forth_ = !forth_;
    return *ramp::arrival(axis, ramp::last_tick);
  }

 private:
  std::mt19937_64 random_{1};
  std::uniform_int_distribution<std::int32_t> place_{0, 20'000};
  bool forth_ = true;
};

/// Every case runs moves that were chosen beforehand, so that nothing but moving is measured.
template <class G>
struct Prepared {
  struct Move {
    G start;
    Tick end;
  };
  std::vector<Move> moves;

  Prepared() {
    Moves<G> source;
    for (int i = 0; i < 200; ++i) {
      const auto end = source.begin();
      moves.push_back({source.axis, end});
      source.axis.advance_to(end);
    }
  }
};

template <class G, class Run>
void run_moves(benchmark::State& state, Run run) {
  static const Prepared<G> prepared;
  double axis_seconds = 0;
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& move = prepared.moves[i++ % prepared.moves.size()];
    run(move);
    axis_seconds += static_cast<double>(move.end - move.start.tick()) / ticks_per_second<G>;
  }
  report(state, axis_seconds);
}

template <class G>
void ticked(benchmark::State& state) {
  run_moves<G>(state, [](const auto& move) { Axis<G>::tick_to(move.start, move.end); });
}

template <class G>
void asked_at_the_end(benchmark::State& state) {
  run_moves<G>(state, [](const auto& move) {
    auto axis = move.start;
    axis.advance_to(move.end);
    benchmark::DoNotOptimize(axis);
  });
}

template <class G>
void polled_1khz(benchmark::State& state) {
  run_moves<G>(state, [](const auto& move) {
    auto axis = move.start;
    while (axis.tick() < move.end) {
      axis.advance_to(axis.tick() + millisecond<G>);
      benchmark::DoNotOptimize(axis.motion().position);
    }
  });
}

template <class G>
void cruising(benchmark::State& state) {
  auto axis = Axis<G>::make();
  Axis<G>::cruise(axis);
  axis.advance_to(100'000 * millisecond<G>);
  double axis_seconds = 0;
  for (auto _ : state) {
    axis.advance_to(axis.tick() + millisecond<G>);
    benchmark::DoNotOptimize(axis.motion().position);
    axis_seconds += 1e-3;
  }
  report(state, axis_seconds);
}

template <class G>
void fleet(benchmark::State& state) {
  constexpr std::size_t axes = 6'000;
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int32_t> target(0, 150'000);
  std::vector<G> all(axes, Axis<G>::make());
  for (auto& axis : all) Axis<G>::go(axis, target(random));
  Tick now = 0;
  double axis_seconds = 0;
  for (auto _ : state) {
    now += 10 * millisecond<G>;
    for (auto& axis : all) {
      axis.advance_to(now);
      if (axis.arrived()) Axis<G>::go(axis, target(random));
    }
    axis_seconds += axes * 1e-2;
  }
  report(state, axis_seconds);
}

template <class G>
void add(const std::string& name) {
  const auto prefix = "ramp/" + name;
  benchmark::RegisterBenchmark((prefix + "/ticked").c_str(), ticked<G>);
  benchmark::RegisterBenchmark((prefix + "/phased/end").c_str(), asked_at_the_end<G>);
  benchmark::RegisterBenchmark((prefix + "/phased/polled_1khz").c_str(), polled_1khz<G>);
  benchmark::RegisterBenchmark((prefix + "/phased/cruising").c_str(), cruising<G>);
  benchmark::RegisterBenchmark((prefix + "/fleet").c_str(), fleet<G>);
}

const int added = [] {
  add<ramp::Tmc429>("tmc429");
  add<ramp::Tmc457>("tmc457");
  add<ramp::Tmc4361>("tmc4361");
  add<ramp::SixPoint>("sixpoint");
  add<ramp::Mc1451a>("mc1451a");
  return 0;
}();

}  // namespace
