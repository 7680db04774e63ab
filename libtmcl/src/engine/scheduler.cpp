#include "engine/scheduler.hpp"

#include <algorithm>

namespace tmcl::engine {
namespace {

using Company = ReplyForm::Company;

// So soon it is noticed that a hold is gone.
constexpr Duration care_interval = std::chrono::milliseconds(50);
constexpr unsigned most_passed_over = 3;
// By stops that are no repetitions: only a flood of stops for very many motors does that.
constexpr unsigned most_passed_over_by_stops = 32;
// So soon after the same stop, and with no movement between, a stop is a repetition.
constexpr Duration repetition_time = std::chrono::seconds(1);

bool needs_the_bus(const Call& call) {
  return ReplyForm::of(call.request).company() == Company::none;
}

}  // namespace

void Scheduler::look_for_bus_wanted(Conversations& modules) {
  const auto wants_it = [&](const Call& queued) {
    return needs_the_bus(queued) && !waits_for_download(modules, queued) &&
           modules.with(queued.request.address).lane.in_step();
  };
  bus_is_wanted_ = modules.framing() == Framing::can && queue_.find(wants_it) != nullptr;
}

Call* Scheduler::next(Conversations& modules) {
  if (is_link_full()) return nullptr;
  const auto find = [&](const auto& goes_first) {
    return queue_.find(
        [&](const Call& call) { return goes_first(call) && is_next(modules, call); });
  };
  if (auto* call = passed_over_most(modules, most_passed_over_by_stops)) return call;
  if (auto* stop = find([&](const Call& call) { return is_urgent(call); })) return stop;
  if (auto* call = passed_over_most(modules, most_passed_over)) return call;
  return find([](const Call&) { return true; });
}

unsigned Scheduler::passed_over(Framing framing, const Call& call) const {
  const auto channel = passed_over_.find(channel_of(framing, call));
  return channel == passed_over_.end() ? 0 : times_in(channel->second, party_of(call));
}

unsigned Scheduler::times_in(const PassedOver& all, Party party) {
  const auto found = std::ranges::find(all, party, &Waiting::party);
  return found == all.end() ? 0 : found->passed_over;
}

Call* Scheduler::passed_over_most(Conversations& modules, unsigned times) {
  Call* found = nullptr;
  auto most = times - 1;
  queue_.for_each([&](Call& call) {
    const auto passed = passed_over(modules.framing(), call);
    if (passed <= most || !is_next(modules, call)) return;
    most = passed;
    found = &call;
  });
  return found;
}

bool Scheduler::is_urgent(const Call& call) const {
  if (!call.is_stop() || call.was_on_the_wire()) return false;
  return std::ranges::none_of(sent_stops_, [&](const SentStop& sent) {
    return sent.request == call.request && now_ - sent.at < repetition_time;
  });
}

void Scheduler::on_turn(Framing framing, const Call& call) {
  const auto channel = channel_of(framing, call);
  auto& before = passed_over_[channel];
  spare_.clear();
  queue_.for_each([&](const Call& queued) {
    const auto party = party_of(queued);
    if (channel_of(framing, queued) != channel || party == party_of(call)) return;
    if (times_in(spare_, party) == 0) spare_.push_back({party, times_in(before, party) + 1});
  });
  std::swap(before, spare_);
  note_stop(call);
}

void Scheduler::note_stop(const Call& call) {
  const auto& request = call.request;
  std::erase_if(sent_stops_, [&](const SentStop& sent) {
    return is_ended_by(sent.request, call) || sent.request == request ||
           now_ - sent.at >= repetition_time;
  });
  if (call.is_stop()) sent_stops_.push_back({request, now_});
}

bool Scheduler::is_next(Conversations& modules, const Call& call) const {
  if (goes_out_early(modules, call)) return true;
  if (waits_for_download(modules, call) || waits_for_bus(modules, call)) return false;
  auto& module = modules.with(call.request.address);
  if (module.lane.is_silent(now_) && !call.is_stop()) return true;
  return modules.channel_of(module).is_free(now_) && !is_alike_under_way(modules, call);
}

bool Scheduler::waits_for_download(Conversations& modules, const Call& call) const {
  auto& module = modules.with(call.request.address);
  if (!module.custody.admits(call)) return true;
  if (modules.framing() != Framing::serial || module.lane.was_heard()) return false;
  // A module on USB takes what is for any address.
  return std::ranges::any_of(modules.all(), [&](const auto& entry) {
    return &entry.second != &module && entry.second.custody.is_recording() &&
           !entry.second.custody.gave_up();
  });
}

/// On CAN some answers look like a reply of any module: no other call may expect one.
bool Scheduler::waits_for_bus(Conversations& modules, const Call& call) const {
  if (modules.framing() != Framing::can || call.is_stop()) return false;
  const bool alone = needs_the_bus(call);
  const auto is_in_the_way = [&](const Channel& channel) {
    return channel.is_busy() && (alone || channel.form_of_answer().company() == Company::none);
  };
  return (bus_is_wanted_ && !alone) || modules.find_channel(is_in_the_way) != nullptr;
}

bool Scheduler::is_alike_under_way(Conversations& modules, const Call& call) {
  const auto& form = ReplyForm::of(call.request);
  const auto is_alike = [&](const Channel& channel) { return channel.awaits(form); };
  return form.company() == Company::other_forms && modules.find_channel(is_alike) != nullptr;
}

bool Scheduler::goes_out_early(Conversations& modules, const Call& call) const {
  if (!call.is_stop() || call.sent_early || call.rescue != Call::Rescue::none) return false;
  auto& module = modules.with(call.request.address);
  // Before the end of a download a stop would only be recorded.
  if (module.custody.is_recording() && !module.custody.end_was_tried()) return false;
  const auto& channel = modules.channel_of(module);
  return (!module.lane.in_step() || channel.is_quiet(now_)) && !channel.is_busy();
}

std::optional<TimePoint> Scheduler::next_deadline(const Conversations& modules) const {
  auto next = queue_.earliest_deadline();
  const auto consider = [&](std::optional<TimePoint> time) {
    if (time && (!next || *time < *next)) next = time;
  };
  const bool calls_wait = queue_.size() > 0;
  if (is_link_full() && calls_wait) consider(full_until_);
  modules.for_each_channel(
      [&](const Channel& channel) { consider(channel.deadline(now_, calls_wait)); });
  for (const auto& [byte, module] : modules.all()) {
    if (module.custody.wants_care()) consider(now_ + care_interval);
  }
  return next;
}

void Scheduler::on_link_full(TimePoint until) {
  link_refused_ = true;
  full_until_ = until;
}

void Scheduler::on_link_took() {
  if (link_refused_) queue_.for_each([](Call& call) { call.refused_since.reset(); });
  link_refused_ = false;
}

}  // namespace tmcl::engine
