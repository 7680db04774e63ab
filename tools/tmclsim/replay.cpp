#include "replay.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "sim/wire/can_line.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/utc_text.hpp"

namespace tmclsim {
namespace {

namespace sim = tmcl::sim;
using tmcl::CanFrame;
using tmcl::TracedDatagram;
using tmcl::Traffic;

// A reply of the record comes later than a virtual one, whose wire takes no time; and at the end of
// the record some may be on their way.
constexpr tmcl::Duration time_for_last_events = std::chrono::seconds(1);

class Replay {
 public:
  Replay(sim::Bench& bench, tmcl::VirtualClock& clock,
         const std::function<void(const std::string&)>& tell)
      : bench_(bench),
        clock_(clock),
        tell_(tell),
        serial_(bench, [this](std::span<const std::uint8_t> bytes) { hear(bytes); }),
        can_(bench, [this](const CanFrame& frame) { hear(frame); }) {}

  ReplayReport run(const tmcl::Trace& trace) {
    if (trace.datagrams.empty()) return report_;
    const auto begin = trace.datagrams.front().at;
    const auto clock_begin = clock_.now();
    for (const auto& datagram : trace.datagrams) {
      advance_to(clock_begin + (datagram.at - begin));
      if (datagram.is_garbage) continue;
      datagram.direction == Traffic::Direction::out ? ask(datagram) : compare(datagram);
    }
    advance_to(clock_.now() + time_for_last_events);
    report_.surplus = given_.size();
    for (const auto& left : given_) tell_("not in the record: " + describe(left));
    return report_;
  }

 private:
  void advance_to(tmcl::TimePoint until) {
    for (auto due = bench_.next_due(); due <= until; due = bench_.next_due()) {
      clock_.advance_to(std::max(due, clock_.now()));
      bench_.run_due();
    }
    // The time of day that a record has may have been set back.
    clock_.advance_to(std::max(until, clock_.now()));
  }

  void ask(const TracedDatagram& request) {
    ++report_.requests;
    if (request.on_can) {
      can_.receive(can_frame_of(request));
    } else {
      serial_.receive(request.bytes);
    }
    bench_.run_due();
  }

  void hear(std::span<const std::uint8_t> bytes) {
    TracedDatagram datagram{{}, Traffic::Direction::in};
    datagram.bytes.assign(bytes.begin(), bytes.end());
    given_.push_back(std::move(datagram));
  }
  void hear(const CanFrame& frame) {
    hear(std::span(frame.data).first(frame.length));
    given_.back().on_can = true;
    given_.back().can_id = frame.id;
    given_.back().can_extended = frame.extended;
  }

  /// The oldest that is to the same command of the same module, or else the oldest.
  std::optional<TracedDatagram> counterpart(const TracedDatagram& recorded) {
    if (given_.empty()) return std::nullopt;
    const auto wanted = reply_of(recorded);
    auto found = std::ranges::find_if(given_, [&](const TracedDatagram& one) {
      const auto reply = reply_of(one);
      return wanted && reply && reply->module == wanted->module &&
             reply->command == wanted->command;
    });
    if (found == given_.end()) found = given_.begin();
    auto taken = std::move(*found);
    given_.erase(found);
    return taken;
  }

  void compare(const TracedDatagram& recorded) {
    const auto given = counterpart(recorded);
    if (!given) {
      ++report_.missing;
      return differs(recorded, "no reply");
    }
    if (given->bytes == recorded.bytes && given->can_id == recorded.can_id) {
      ++report_.equal;
      return;
    }
    auto mine = reply_of(*given);
    const auto theirs = reply_of(recorded);
    if (mine && theirs) mine->value = theirs->value;
    ++(mine && theirs && *mine == *theirs ? report_.other_values : report_.other_replies);
    differs(recorded, describe(*given));
  }
  void differs(const TracedDatagram& recorded, const std::string& given) const {
    tell_(fmt::format("{}  recorded: {}  here: {}", tmcl::to_text(recorded.at), describe(recorded),
                      given));
  }

  sim::Bench& bench_;
  tmcl::VirtualClock& clock_;
  const std::function<void(const std::string&)>& tell_;
  sim::SerialLine serial_;
  sim::CanLine can_;
  std::deque<TracedDatagram> given_;  ///< By the virtual modules, and not compared yet.
  ReplayReport report_;
};

}  // namespace

ReplayReport replay(const tmcl::Trace& trace, sim::Bench& bench, tmcl::VirtualClock& clock,
                    const std::function<void(const std::string&)>& tell) {
  return Replay(bench, clock, tell).run(trace);
}

std::string describe(const ReplayReport& report) {
  auto text = fmt::format("{} requests: {} replies as recorded", report.requests, report.equal);
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(report.other_values, "with another value");
  add(report.other_replies, "otherwise different");
  add(report.missing, "missing");
  add(report.surplus, "too many");
  return text;
}

}  // namespace tmclsim
