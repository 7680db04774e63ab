// A host that samples a simulated motor over a pty sees the curve of the library's generator. The
// only doubt is the time: when exactly a command was executed between its request and its reply.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "support/program.hpp"
#include "tmcl/blocking.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::test {
namespace {

namespace ap = axis_parameter;
using ramp::Tick;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::int32_t target = 60'000;
constexpr double clock_hz = 16e6;

// A command was executed at some time between these two.
struct Bracket {
  Clock::time_point before;
  Clock::time_point after;
  Clock::duration width() const { return after - before; }
};

struct Sample {
  std::uint8_t parameter;
  std::int32_t value;
  Bracket when;
};

struct Recording {
  Bracket start;
  std::vector<Sample> samples;
};

struct Setting {
  std::uint8_t parameter;
  std::int32_t value;
};

// One simulator with one module of each kind.
class Host {
 public:
  explicit Host(AxisAddress axis)
      : folder_(make_folder()),
        simulator_({"tmclsim", "--module", "TMCM-1110@1", "--module", "TMCM-142@2", "--module",
                    "TMCM-6212@3", "--pty", folder_ + "/bus"}),
        ready_(simulator_.wait_for("ready")),
        bus_(blocking::Bus::open("serial:" + folder_ + "/bus@115200")),
        axis_(bus_.value().module(axis.module).axis(axis.motor)) {}
  ~Host() { std::filesystem::remove_all(folder_); }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  void set(const std::vector<Setting>& settings) {
    for (const auto& [parameter, value] : settings) {
      EXPECT_TRUE(axis_.set(parameter, value)) << int{parameter};
    }
  }

  Bracket move() {
    const auto before = Clock::now();
    EXPECT_TRUE(axis_.move_to({target}));
    return {before, Clock::now()};
  }

  // Position and velocity in turn, until the motor has stood on its target for a while.
  std::vector<Sample> watch() {
    std::vector<Sample> samples;
    const auto end = Clock::now() + std::chrono::seconds(20);
    for (int at_target = 0; at_target < 10 && Clock::now() < end;) {
      samples.push_back(sample(ap::actual_velocity));
      samples.push_back(sample(ap::actual_position));
      if (samples.back().value == target) ++at_target;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return samples;
  }

 private:
  static std::string make_folder() {
    std::string name = std::filesystem::temp_directory_path() / "tmclsim-XXXXXX";
    return ::mkdtemp(name.data());
  }

  Sample sample(std::uint8_t parameter) {
    const auto before = Clock::now();
    const auto value = axis_.get(parameter);
    const auto after = Clock::now();
    EXPECT_TRUE(value);
    return {parameter, value.value_or(INT32_MIN), {before, after}};
  }

  std::string folder_;
  Program simulator_;
  bool ready_;
  Result<blocking::Bus> bus_;
  blocking::Axis axis_;
};

// On a busy machine it may take several attempts until the start of the move is known well.
Recording record(AxisAddress axis, const std::vector<Setting>& settings) {
  constexpr int most_attempts = 50;
  for (int attempt = 1;; ++attempt) {
    Host host(axis);
    host.set(settings);
    Recording recording{host.move(), {}};
    const bool is_well_known = recording.start.width() <= milliseconds(2);
    if (!is_well_known && attempt < most_attempts) continue;
    EXPECT_TRUE(is_well_known) << "in none of " << attempt << " attempts";
    recording.samples = host.watch();
    return recording;
  }
}

struct Range {
  std::int64_t least;
  std::int64_t greatest;
  void include(std::int64_t value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
};

// The generator, alone, on its way from the write that starts the move.
template <ramp::Generator G>
class Reference {
 public:
  /// `grid`: a write acts at the next tick that is a multiple of it. The generator is one tick
  /// before such a one.
  Reference(G moving, Tick grid) : moving_(std::move(moving)), grid_(grid) {}

  // The ticks, each as the generator counts them, in one of which the module took this sample.
  std::pair<Tick, Tick> ticks(const Bracket& start, const Bracket& sample) const {
    const auto least = passed(sample.before - start.after);
    const auto most = passed(sample.after - start.before) + 1;
    // The module may have had to wait longer for the grid than the generator.
    const auto waited = std::min(least, grid_ - 1);
    return {moving_.tick() + least - waited, moving_.tick() + most};
  }

  Range positions(std::pair<Tick, Tick> ticks) const {
    return {at(ticks.first).motion().position, at(ticks.second).motion().position};
  }

  // Between two changes the velocity does not turn round.
  Range velocities(std::pair<Tick, Tick> ticks) const {
    auto g = at(ticks.first);
    Range range{g.motion().velocity, g.motion().velocity};
    while (g.tick() < ticks.second) {
      const auto next = std::min(ticks.second, g.next_change());
      for (const auto tick : {next - 1, next}) {
        g.advance_to(tick);
        range.include(g.motion().velocity);
      }
    }
    return range;
  }

 private:
  Tick passed(Clock::duration duration) const {
    const auto per_second = static_cast<std::int64_t>(G::ticks_per_second(clock_hz));
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
    return static_cast<Tick>(std::max<std::int64_t>(0, ns * per_second / 1'000'000'000));
  }
  G at(Tick tick) const {
    auto g = moving_;
    g.advance_to(tick);
    return g;
  }

  G moving_;
  Tick grid_;
};

// `unit`: what the module makes of a velocity of the generator.
template <class G, class Unit>
void expect_same_curve(const Recording& recording, const Reference<G>& reference, Unit unit) {
  int sharp = 0;
  std::int64_t fastest = 0;
  for (const auto& [parameter, value, when] : recording.samples) {
    const auto ticks = reference.ticks(recording.start, when);
    const bool is_position = parameter == ap::actual_position;
    const auto range = is_position ? reference.positions(ticks) : reference.velocities(ticks);
    EXPECT_GE(value, is_position ? range.least : unit(range.least))
        << int{parameter} << " at " << ticks.first;
    EXPECT_LE(value, is_position ? range.greatest : unit(range.greatest))
        << int{parameter} << " at " << ticks.first;
    if (!is_position) fastest = std::max<std::int64_t>(fastest, value);
    if (when.width() + recording.start.width() < milliseconds(5)) ++sharp;
  }
  EXPECT_GE(sharp, 50) << "of " << recording.samples.size();
  EXPECT_GT(fastest, 0);
  EXPECT_EQ(recording.samples.back().value, target);
}

constexpr auto as_it_is = [](std::int64_t velocity) { return velocity; };

TEST(TmclsimCurve, IsThatOfTheTmc429) {
  const auto recording =
      record({ModuleAddress{1}, 0}, {{154, 2}, {153, 3}, {130, 1}, {4, 1000}, {5, 20}});
  using R = ramp::Tmc429::Register;
  ramp::Tmc429 chip;
  chip.write(R::pulse_div, 2);
  chip.write(R::ramp_div, 3);
  chip.write(R::v_min, 1);
  chip.write(R::v_max, 1000);
  chip.write(R::a_max, 20);
  // Both stages count from power-on, in steps of four and of eight ticks.
  constexpr Tick grid = 8;
  chip.advance_to(grid - 1);
  chip.write(R::x_target, target);
  expect_same_curve(recording, Reference(chip, grid), as_it_is);
}

TEST(TmclsimCurve, IsThatOfTheTmc457) {
  const auto recording =
      record({ModuleAddress{2}, 0}, {{255, 0}, {4, 5'000'000}, {16, 6'000}, {17, 8'000}, {18, 3}});
  using R = ramp::Tmc457::Register;
  ramp::Tmc457 chip;
  chip.write(R::v_max, 5'000'000);
  chip.write(R::a_max, 6'000);
  chip.write(R::d_max, 8'000);
  chip.write(R::bow_max, 3);
  chip.write(R::x_target, target);
  expect_same_curve(recording, Reference(chip, 1), as_it_is);
}

TEST(TmclsimCurve, IsThatOfASixPointChip) {
  // Set in the chip's units, and read in microsteps per second.
  const auto recording = record({ModuleAddress{3}, 4}, {{255, 0},
                                                        {15, 900},
                                                        {16, 20'000},
                                                        {5, 1'700},
                                                        {4, 60'000},
                                                        {17, 1'300},
                                                        {18, 700},
                                                        {19, 100},
                                                        {20, 200},
                                                        {255, 1}});
  using R = ramp::SixPoint::Register;
  ramp::SixPoint chip;
  chip.write(R::a1, 900);
  chip.write(R::v1, 20'000);
  chip.write(R::amax, 1'700);
  chip.write(R::vmax, 60'000);
  chip.write(R::dmax, 1'300);
  chip.write(R::d1, 700);
  chip.write(R::vstart, 100);
  chip.write(R::vstop, 200);
  chip.write(R::xtarget, target);
  expect_same_curve(recording, Reference(chip, 1), [](std::int64_t velocity) {
    return static_cast<std::int64_t>(
        std::ceil(static_cast<double>(velocity) * clock_hz / (1 << 24)));
  });
}

}  // namespace
}  // namespace tmcl::test
