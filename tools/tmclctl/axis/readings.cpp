#include "readings.hpp"

#include <algorithm>
#include <deque>
#include <utility>
#include <variant>

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;
using tmcl::client::Hearing;

// Of one call that waits: shorter than any client waits for an answer.
constexpr tmcl::Duration longest_wait_call = std::chrono::seconds(5);
// The same where there is something to do meanwhile. A call sees that an axis stands short of its
// goal after a second of standstill: a shorter one would never.
constexpr tmcl::Duration short_wait_call = std::chrono::seconds(2);

AxisReading reading_of(const api::axis::State& state, const Context& context) {
  return {state, context.host.now() - std::chrono::milliseconds(state.age_ms)};
}
AxisReading reading_of(const api::PublishedState& state, const Context& context) {
  const api::axis::State& plain = state;
  auto reading = reading_of(plain, context);
  reading.samples = state.samples;
  return reading;
}

std::int32_t in_milliseconds(tmcl::Duration interval) {
  return static_cast<std::int32_t>(std::chrono::round<std::chrono::milliseconds>(interval).count());
}

/// Asked anew every few seconds: a gateway that says nothing any more is noticed.
Result<Warnings> await_standing(const Wait& wait, Context& context) {
  using std::chrono::milliseconds;
  const auto begin = context.host.now();
  const auto longest = wait.meanwhile ? short_wait_call : longest_wait_call;
  while (true) {
    if (auto going_on = wait.meanwhile ? wait.meanwhile() : Result<void>(); !going_on)
      return tl::unexpected(going_on.error());
    const auto left = wait.at_most.value_or(tmcl::Duration::max()) - (context.host.now() - begin);
    const auto call_time = std::clamp<tmcl::Duration>(left, shortest_wait, longest);
    const api::axis::Wait call{wait.axis, std::chrono::ceil<milliseconds>(call_time).count(),
                               wait.goal.value};
    const auto stands = context.call(call);
    if (stands) return stands->warnings;
    const bool goes_on =
        stands.error().name == name_of(tmcl::Errc::deadline_passed) && left > longest;
    if (!goes_on) return tl::unexpected(stands.error());
  }
}

}  // namespace

Result<AxisReading> state_of(const std::string& axis, Context& context) {
  return context.call(api::axis::GetState{axis}).map([&](const api::axis::State& state) {
    return reading_of(state, context);
  });
}

Result<void> watch(const std::string& axis, tmcl::Duration interval,
                   const ReadingHandler& on_reading, Context& context) {
  bool wanted = true;
  auto heard_at = context.host.now();
  const auto note = [&](const api::axis::State& state) {
    const auto reading = reading_of(state, context);
    if (wanted) wanted = on_reading(&reading);
  };
  const Hearing<api::NewState> hearing(context.gateway.caller, api::NewState::notification,
                                       [&](const api::NewState& news) {
                                         heard_at = context.host.now();
                                         note(news);
                                       });
  const auto subscribed = context.call(api::Subscribe{{{axis}}, in_milliseconds(interval)});
  if (!subscribed) return tl::unexpected(subscribed.error());
  for (const auto& failed : subscribed->failed)
    return tl::unexpected(tmcl::client::error_from_json(failed.error));
  for (const auto& state : subscribed->states) note(state);
  while (wanted) {
    auto listened = context.gateway.caller.listen(longest_silence);
    if (!listened && listened.error().kind != ErrorKind::interrupted) return listened;
    if (wanted) wanted = on_reading(nullptr);
    if (!wanted || context.host.now() - heard_at < doubtful_silence) continue;
    // Nothing comes from an axis that stands, and neither from one that is gone.
    const auto reading = state_of(axis, context);
    if (!reading && context.host.signal() == 0) return tl::unexpected(reading.error());
    heard_at = context.host.now();
  }
  return {};
}

Result<Warnings> wait_for(const Wait& wait,
                          const std::function<void(const AxisReading&)>& on_reading,
                          Context& context) {
  std::optional<Hearing<api::NewState>> hearing(
      std::in_place, context.gateway.caller, api::NewState::notification,
      [&](const api::NewState& news) { on_reading(reading_of(news, context)); });
  api::Subscribe subscribe{{{wait.axis}}, in_milliseconds(wait.interval)};
  const auto& [others, parameters, every_look] = wait.beside;
  subscribe.axes->insert(subscribe.axes->end(), others.begin(), others.end());
  if (!parameters.empty()) subscribe.parameters = parameters;
  if (every_look) subscribe.every_look = true;
  const auto subscribed = context.call(subscribe);
  if (!subscribed) return tl::unexpected(subscribed.error());
  for (const auto& now : subscribed->states) on_reading(reading_of(now, context));
  auto stands = await_standing(wait, context);
  hearing.reset();
  // Nothing answers any more, or the answer is not wanted.
  const bool is_over = stands || exit_code_of(stands.error()) == ExitCode::not_reached;
  if (!is_over || (!stands && context.host.signal() != 0)) return stands;
  const auto last = state_of(wait.axis, context);
  if (last) on_reading(*last);
  if (stands && !last) return tl::unexpected(last.error());
  const api::Unsubscribe unsubscribe{static_cast<std::int32_t>(subscribed->subscription)};
  const auto ended = context.call(unsubscribe);
  if (stands && !ended) return tl::unexpected(ended.error());
  return stands;
}

namespace {

/// What was heard, to be handed out later: what a handler asks is answered while the next
/// notifications come.
class News {
 public:
  News(const AxesWatcher& watcher, Context& context) : watcher_(watcher), context_(context) {
    context.gateway.caller.on_notification(
        [this](std::string_view method, const json::object& params) {
          if (method == api::NewState::notification)
            heard_.emplace_back(api::from_json<api::NewState>(params));
          if (method == api::Event::notification)
            heard_.emplace_back(api::from_json<api::Event>(params));
        });
  }
  ~News() { context_.gateway.caller.on_notification({}); }
  News(const News&) = delete;
  News& operator=(const News&) = delete;

  void hand_out() {
    for (; !heard_.empty(); heard_.pop_front()) {
      const auto& news = heard_.front();
      if (const auto* state = std::get_if<api::NewState>(&news)) tell(*state);
      const auto* event = std::get_if<api::Event>(&news);
      if (event != nullptr && watcher_.on_event) watcher_.on_event(*event);
    }
  }
  void tell(const api::PublishedState& state) {
    if (watcher_.on_reading) watcher_.on_reading(state.axis, reading_of(state, context_));
  }

 private:
  const AxesWatcher& watcher_;
  Context& context_;
  std::deque<std::variant<api::NewState, api::Event>> heard_;
};

}  // namespace

Result<void> watch_axes(const Watched& watched, const AxesWatcher& watcher, Context& context) {
  News news(watcher, context);
  api::Subscribe subscribe{.interval_ms = in_milliseconds(watched.interval)};
  if (!watched.axes.empty()) subscribe.axes = watched.axes;
  if (!watched.parameters.empty()) subscribe.parameters = watched.parameters;
  if (watched.every_look) subscribe.every_look = true;
  const auto subscribed = context.call(subscribe);
  if (!subscribed) return tl::unexpected(subscribed.error());
  for (const auto& state : subscribed->states) news.tell(state);
  for (const auto& [axis, error] : subscribed->failed)
    if (watcher.on_error) watcher.on_error(axis, tmcl::client::error_from_json(error));
  Result<void> result;
  while (result && watcher.wanted()) {
    result = context.gateway.caller.listen(longest_silence);
    news.hand_out();
  }
  return result;
}

}  // namespace tmclctl
