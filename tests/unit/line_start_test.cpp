// Lines on simulated modules in virtual time, on wires of a given speed: when the motors start, and
// when they arrive.
#include <gtest/gtest.h>

#include <deque>
#include <memory>

#include "sim/bench.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/address.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/plan/line.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
namespace ap = axis_parameter;

constexpr Duration look_interval = microseconds(100);

/// Modules on one wire, and a host that sends the next request when the answer is there. Requests
/// and answers take half of an exchange each.
class Wire {
 public:
  Wire(VirtualClock& clock, Duration exchange) : clock_(clock), half_(exchange / 2) {}

  sim::Module& add(const char* model, std::uint16_t address) {
    return bench_.add(*find_model(model), ModuleAddress{address});
  }

  void send(const Request& request) {
    waiting_.push_back(request);
    if (waiting_.size() == 1) begin();
  }
  bool is_busy() const { return !waiting_.empty(); }
  TimePoint next_due() const { return std::min(bench_.next_due(), due_); }
  void run_due() {
    bench_.run_due();
    if (clock_.now() < due_) return;
    if (!is_answer_) {
      carry_out(waiting_.front());
      if (waiting_.front().command == Command::MVP) starts.push_back(clock_.now());
      is_answer_ = true;
      due_ += half_;
      return;
    }
    exchanges.push_back(clock_.now() - asked_);
    waiting_.pop_front();
    due_ = sim::never;
    if (is_busy()) begin();
  }

  /// A look from outside, which takes no time.
  Reply carry_out(const Request& request) {
    line_.receive(encode_serial(request));
    return *decode_serial_reply(std::span<const std::uint8_t, 9>(answer_.data(), 9));
  }

  std::vector<Duration> exchanges;
  std::vector<TimePoint> starts;

 private:
  void begin() {
    asked_ = clock_.now();
    is_answer_ = false;
    due_ = asked_ + half_;
  }

  VirtualClock& clock_;
  Duration half_;
  sim::Bench bench_{clock_};
  std::vector<std::uint8_t> answer_;
  sim::SerialLine line_{bench_, [this](auto bytes) { answer_.assign(bytes.begin(), bytes.end()); }};
  std::deque<Request> waiting_;
  bool is_answer_ = false;
  TimePoint asked_{};
  TimePoint due_ = sim::never;
};

/// Axes on wires, driven along a line.
class Table {
 public:
  void add_wire(Duration exchange) { wires_.push_back(std::make_unique<Wire>(clock_, exchange)); }
  /// Of a module that is there already, or of a new one.
  void add_axis(std::size_t bus, std::uint16_t address, std::int32_t target,
                std::uint8_t motor = 0) {
    if (motor == 0) wires_[bus]->add(model, address);
    auto twin = *AxisTwin::of(*find_model(model));
    twin.place({0});
    axes_.push_back({twin, {target}, twin.to_pps({1000}), twin.to_pps2({500}), bus});
    places_.push_back({bus, {ModuleAddress{address}, motor}});
  }

  void drive(bool one_command) {
    measure();
    line_ = plan_line(axes_, one_command ? ExchangeTimes{} : exchanges()).value();
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      for (const auto setting : line_.axes[i].settings)
        send(i, Command::SAP, setting.parameter, setting.value);
      if (one_command) send(i, Command::SCO, 0, axes_[i].target.value);
    }
    settle();
    for (const auto& wire : wires_) wire->starts.clear();
    if (one_command) {
      const Request all{places_[0].address.module, Command::MVP, 2, motors(), 0};
      wires_[0]->send(all);
    } else {
      for (const auto i : line_.order) send(i, Command::MVP, 0, axes_[i].target.value);
    }
    watch();
  }

  Duration predicted_skew() const {
    std::vector<std::size_t> buses;
    for (const auto i : line_.order) buses.push_back(axes_[i].bus);
    return std::ranges::max(start_times(buses, exchanges()));
  }
  Duration skew() const {
    std::vector<TimePoint> starts;
    for (const auto& wire : wires_)
      starts.insert(starts.end(), wire->starts.begin(), wire->starts.end());
    return std::ranges::max(starts) - std::ranges::min(starts);
  }
  Duration spread() const { return std::ranges::max(arrivals_) - std::ranges::min(arrivals_); }
  const Line& line() const { return line_; }

 private:
  static constexpr const char* model = "TMCM-6110";

  struct Place {
    std::size_t bus;
    AxisAddress address;
  };

  // The twin's readings, as the daemon makes them.
  void measure() {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      send(i, Command::GAP, ap::actual_velocity, 0);
      send(i, Command::GAP, ap::actual_position, 0);
    }
    settle();
  }
  ExchangeTimes exchanges() const {
    ExchangeTimes exchanges;
    for (const auto& wire : wires_) exchanges.push_back(wire->exchanges.back());
    return exchanges;
  }
  std::uint8_t motors() const {
    unsigned bits = 0x80;
    for (const auto i : line_.order) bits |= 1U << places_[i].address.motor;
    return static_cast<std::uint8_t>(bits);
  }
  void send(std::size_t axis, Command command, std::uint8_t type, std::int32_t value) {
    const auto& [bus, address] = places_[axis];
    wires_[bus]->send({address.module, command, type, address.motor, value});
  }

  void go_on_until(TimePoint limit) {
    auto due = limit;
    for (const auto& wire : wires_) due = std::min(due, wire->next_due());
    clock_.advance_to(std::max(due, clock_.now()));
    for (const auto& wire : wires_) wire->run_due();
  }
  void settle() {
    const auto is_busy = [](const auto& wire) { return wire->is_busy(); };
    while (std::ranges::any_of(wires_, is_busy)) go_on_until(sim::never);
  }
  void watch() {
    arrivals_.assign(axes_.size(), TimePoint{});
    const auto limit = clock_.now() + 2 * line_.duration;
    while (std::ranges::count(arrivals_, TimePoint{}) > 0 && clock_.now() < limit) {
      const auto next = clock_.now() + look_interval;
      while (clock_.now() < next) go_on_until(next);
      for (std::size_t i = 0; i < axes_.size(); ++i) look_at(i);
    }
    EXPECT_EQ(std::ranges::count(arrivals_, TimePoint{}), 0) << "some do not arrive";
  }
  void look_at(std::size_t i) {
    if (arrivals_[i] != TimePoint{}) return;
    const auto& [bus, address] = places_[i];
    const auto here = wires_[bus]->carry_out(
        {address.module, Command::GAP, ap::actual_position, address.motor, 0});
    if (here.value == axes_[i].target.value) arrivals_[i] = clock_.now();
  }

  VirtualClock clock_;
  std::vector<std::unique_ptr<Wire>> wires_;
  std::vector<LineAxis> axes_;
  std::vector<Place> places_;
  Line line_;
  std::vector<TimePoint> arrivals_;
};

void expect_near(Duration predicted, Duration actual) {
  EXPECT_GE(predicted, actual * 8 / 10);
  EXPECT_LE(predicted, actual * 12 / 10);
}

// 115200 baud and a module that takes 200 us.
constexpr Duration slow_exchange = microseconds(1762);
constexpr Duration fast_exchange = microseconds(380);

TEST(LineStart, SkewOnOneBusIsWhatTheReadingsSay) {
  Table table;
  table.add_wire(slow_exchange);
  table.add_axis(0, 1, 20'000);
  table.add_axis(0, 2, -8'000);
  table.add_axis(0, 3, 3'000);
  table.drive(false);
  EXPECT_EQ(table.skew(), 2 * slow_exchange) << "(N-1) commands";
  expect_near(table.predicted_skew(), table.skew());
}

TEST(LineStart, SkewOnTwoBusesOfDifferentSpeedIsThatOfTheSlowerOne) {
  Table table;
  table.add_wire(slow_exchange);
  table.add_wire(fast_exchange);
  for (std::uint16_t i = 1; i <= 3; ++i) {
    table.add_axis(0, i, 20'000 - i * 4'000);
    table.add_axis(1, i, 10'000 - i * 2'500);
  }
  table.drive(false);
  EXPECT_LT(table.skew(), 3 * slow_exchange);
  expect_near(table.predicted_skew(), table.skew());
}

TEST(LineStart, OneAxisOnEachOfTwoBusesIsApartByHalfTheDifference) {
  Table table;
  table.add_wire(slow_exchange);
  table.add_wire(fast_exchange);
  table.add_axis(0, 1, 20'000);
  table.add_axis(1, 1, 10'000);
  table.drive(false);
  EXPECT_EQ(table.skew(), (slow_exchange - fast_exchange) / 2);
  expect_near(table.predicted_skew(), table.skew());
}

// Without the plan's correction they would arrive by the skew of 40 ms further apart.
TEST(LineStart, TheyArriveAsThePlanSaysAlthoughTheyStartInTurn) {
  Table table;
  table.add_wire(milliseconds(20));
  table.add_axis(0, 1, 20'000);
  table.add_axis(0, 2, -8'000);
  table.add_axis(0, 3, 3'000);
  table.drive(false);
  EXPECT_LE(table.spread(), table.line().spread + 2 * look_interval);
}

void add_three_motors(Table& table) {
  table.add_wire(slow_exchange);
  table.add_axis(0, 1, 20'000, 0);
  table.add_axis(0, 1, -8'000, 1);
  table.add_axis(0, 1, 3'000, 2);
}

TEST(LineStart, InTurnTheyArriveAsMuchTogetherAsByOneCommandButForTheSkew) {
  Table at_once, in_turn;
  for (auto* table : {&at_once, &in_turn}) add_three_motors(*table);
  at_once.drive(true);
  in_turn.drive(false);
  EXPECT_EQ(at_once.skew(), Duration{});
  EXPECT_EQ(in_turn.skew(), 2 * slow_exchange);
  EXPECT_LE(in_turn.spread(), at_once.spread() + in_turn.skew());
}

}  // namespace
}  // namespace tmcl::plan
