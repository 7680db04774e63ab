#include "sim/program/processor.hpp"

#include <algorithm>
#include <utility>

#include "sim/module/due.hpp"

namespace tmcl::sim {

void Processor::clear() {
  state_ = State::stopped;
  interrupts_.reset();
  step_pending_ = false;
  counter_ = next_ = 0;
  calculator_.registers = {};
  errors_ = 0;
  calls_.clear();
  interrupted_.reset();
  wait_.reset();
  last_error_.reset();
}

void Processor::reset() {
  clear();
  state_ = State::reset;
}

void Processor::begin(State state, TimePoint now) {
  state_ = state;
  ready_ = observed_ = now;
  last_error_.reset();
  past_breakpoint_ = true;
}

void Processor::run(TimePoint now) {
  if (state_ == State::running) return;
  wait_.reset();
  begin(State::running, now);
}

void Processor::run_from(std::uint16_t address, TimePoint now) {
  clear();
  counter_ = address;
  begin(State::running, now);
}

void Processor::step(TimePoint now) {
  if (active()) return;
  begin(State::stepping, now);
  step_pending_ = true;
  run_due(now);
}

bool Processor::active() const {
  return state_ == State::running || (state_ == State::stepping && step_pending_);
}

Processor::Inside Processor::inside() const {
  const auto resumes = interrupted_ ? std::optional(interrupted_->counter) : std::nullopt;
  return {state_,  counter_, last_error_, calculator_.registers, errors_, calls_,
          resumes, active(), ready_};
}

bool Processor::add_breakpoint(std::uint16_t address) {
  if (std::ranges::find(breakpoints_, address) != breakpoints_.end()) return true;
  if (breakpoints_.size() == most_breakpoints) return false;
  breakpoints_.push_back(address);
  return true;
}

void Processor::remove_breakpoint(std::uint16_t address) { std::erase(breakpoints_, address); }

void Processor::run_due(TimePoint now) {
  if (!active()) return;
  observe(now);
  if (!interrupted_) enter_interrupt(now);
  if (wait_ && !finish_wait(now)) return;
  if (active() && now >= ready_) execute_next(now);
}

TimePoint Processor::next_due() const {
  if (!active()) return never;
  if (!wait_) return ready_;
  auto due = std::min(wait_->end, interrupts_.next_due());
  if (wait_->what != WaitFor::ticks || interrupts_.listening())
    due = std::min(due, host_->next_event());
  // A module that cannot say when something will change is asked again and again.
  return due > observed_ ? due : observed_ + command_time;
}

void Processor::observe(TimePoint now) {
  observed_ = now;
  interrupts_.observe(now);
  const auto alarms = host_->alarms();
  if (alarms.external) raise(ErrorFlag::alarm);
  if (alarms.deviation) raise(ErrorFlag::deviation);
  if (alarms.position) raise(ErrorFlag::position);
  if (alarms.shutdown) raise(ErrorFlag::shutdown);
}

void Processor::enter_interrupt(TimePoint now) {
  const auto routine = interrupts_.take();
  if (!routine) return;
  if (wait_) ready_ = now;
  interrupted_ = Context{calculator_.registers, counter_, std::exchange(wait_, std::nullopt)};
  counter_ = *routine;
}

bool Processor::finish_wait(TimePoint now) {
  const bool happened = has_happened(*wait_);
  if (!happened && now < wait_->end) return false;
  if (!happened && wait_->what != WaitFor::ticks) raise(ErrorFlag::timeout);
  wait_.reset();
  counter_ = static_cast<std::uint16_t>(counter_ + 1);
  ready_ = now;
  step_pending_ = false;
  return active();
}

bool Processor::has_happened(const Wait& wait) const {
  if (wait.what == WaitFor::ticks) return false;
  const auto motor = host_->motor(wait.motor);
  switch (wait.what) {
    case WaitFor::ticks: return false;
    case WaitFor::position: return motor.at_target;
    case WaitFor::reference_switch: return motor.home_switch;
    case WaitFor::limit_switch: return motor.left_switch || motor.right_switch;
    case WaitFor::search: return !motor.searching;
  }
  return true;
}

bool Processor::at_breakpoint() const {
  return state_ == State::running && !past_breakpoint_ &&
         std::ranges::find(breakpoints_, counter_) != breakpoints_.end();
}

void Processor::execute_next(TimePoint now) {
  if (at_breakpoint()) {
    state_ = State::stepping;
    return;
  }
  const auto line = memory_->read(counter_);
  if (!line) return fail(Status::invalid_value);
  if (line->command == Command{}) return stop();
  past_breakpoint_ = false;
  ready_ = now + command_time;
  next_ = static_cast<std::uint16_t>(counter_ + 1);
  const auto status = execute(*line, now);
  if (status != Status::ok) return fail(status);
  counter_ = next_;
  if (!wait_) step_pending_ = false;
}

void Processor::fail(Status status) {
  last_error_ = status;
  stop();
}

}  // namespace tmcl::sim
