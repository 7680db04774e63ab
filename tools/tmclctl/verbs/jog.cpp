// jog.
#include <charconv>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "axis/held_lease.hpp"
#include "axis/jog_keys.hpp"
#include "output/full_screen.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

constexpr tmcl::Duration key_look_interval = std::chrono::milliseconds(10);
constexpr tmcl::Duration draw_interval = std::chrono::milliseconds(200);
/// Nothing that takes longer is of use to a person who holds a key.
constexpr tmcl::Duration time_for_call = std::chrono::seconds(2);
/// An axis stops without it, by its hold: it must outlast a computer that is busy.
constexpr std::int64_t lease_ttl_ms = 5'000;
/// Of max_velocity, unless --velocity says otherwise.
constexpr int usual_part = 5;

/// How fast an axis goes at 100 %.
struct JogSpeed {
  double number = 0;
  std::string unit{};  ///< Empty: what the module counts in.

  Typed typed(int percent_of_it, int direction) const {
    const auto part = number * percent_of_it / 100 * direction;
    if (unit.empty()) return {std::to_string(std::lround(part)), true};
    return {tmcl::plain_number(part, 10) + unit, false};
  }
};

Result<JogSpeed> speed_of(const verb::Jog& verb, const std::string& axis, Context& context) {
  if (verb.velocity.empty()) {
    api::parameter::Get wanted;
    wanted.axis = axis;
    wanted.parameter.said = "max_velocity";
    const auto most = context.call(wanted);
    if (!most) return tl::unexpected(most.error());
    return JogSpeed{static_cast<double>(most->value) / usual_part};
  }
  JogSpeed speed;
  const auto* end = verb.velocity.data() + verb.velocity.size();
  const auto read = std::from_chars(verb.velocity.data(), end, speed.number);
  if (read.ec != std::errc() || speed.number <= 0)
    return tl::unexpected(usage_error(
        "bad_quantity", "'" + verb.velocity + "' is no velocity above 0", "5mm/s, or 2rps"));
  speed.unit = std::string(read.ptr, end);
  if (speed.unit.empty() != verb.internal)
    return tl::unexpected(usage_error(
        "bad_quantity", "a velocity has a unit, or is in the module's own with --internal",
        "--velocity 5mm/s, or --velocity 500 --internal"));
  return speed;
}

/// Axes that go while keys are held, until q is pressed.
class Jog {
 public:
  Jog(const verb::Jog& verb, std::vector<JogSpeed> speeds, FullScreen& screen, Context& context)
      : verb_(verb),
        speeds_(std::move(speeds)),
        screen_(screen),
        context_(context),
        keys_(verb.axes.size()),
        shown_(verb.axes.size()) {}

  Result<void> run(HeldLease& lease) {
    auto ended = go_on(lease);
    context_.host.take_signal();
    // Whatever has ended it: also what it is not known to have moved.
    auto stopped = stop_all();
    return ended ? stopped : ended;
  }

 private:
  Result<void> go_on(HeldLease& lease) {
    while (!keys_.has_ended() && context_.host.signal() == 0) {
      if (auto attended = attend(); !attended) return attended;
      for (const auto& going : keys_.take_going(context_.host.now())) jog(going);
      for (const auto& step : keys_.take_steps()) make_step(step);
      if (auto renewed = lease.renew(context_, attending()); !renewed) return renewed;
      draw();
      context_.sleep(key_look_interval);
    }
    return {};
  }

  /// Also while a call is under way: a stop waits for none.
  Result<void> attend() {
    std::vector<Key> pressed;
    while (const auto key = screen_.take_key()) pressed.push_back(*key);
    keys_.look(pressed, context_.host.now());
    const auto released = keys_.take_released();
    if (!keys_.take_stop()) return stop(released);
    message_ = "stopped";
    return stop_all();
  }

  tmcl::client::CallOptions attending() {
    return {.timeout = time_for_call, .meanwhile = [this] {
              if (auto stopped = attend(); !stopped) message_ = stopped.error().message;
            }};
  }

  void jog(const JogKeys::Going& going) {
    const auto velocity = speeds_[going.axis].typed(going.percent, going.direction);
    note(context_.call(api::axis::Jog{verb_.axes[going.axis], velocity.counted(), velocity.amount(),
                                      going.hold.count()},
                       attending()));
  }

  void make_step(const JogKeys::Step& step) {
    const auto& unit = shown_[step.axis].unit;
    const auto length = std::pow(10.0, keys_.step_power()) * step.direction;
    Typed distance{tmcl::plain_number(length) + unit.value_or(""), !unit};
    if (!unit) distance.text = std::to_string(std::lround(length));
    note(context_.call(api::axis::MoveBy{verb_.axes[step.axis], distance.counted(),
                                         distance.amount(), false, move_deadline_ms},
                       attending()));
  }

  template <class T>
  void note(const Result<T>& result) {
    message_ = result ? std::string() : result.error().message;
  }

  Result<void> stop_all() {
    std::vector<std::size_t> all(verb_.axes.size());
    std::iota(all.begin(), all.end(), 0);
    return stop(all);
  }

  Result<void> stop(const std::vector<std::size_t>& axes) {
    std::optional<Error> failed;
    for (const auto axis : axes) {
      const auto stopped = context_.call(api::axis::Stop{verb_.axes[axis]},
                                         {.timeout = time_for_call, .meanwhile = {}});
      if (!stopped) failed = stopped.error();
    }
    if (failed) return tl::unexpected(std::move(*failed));
    return {};
  }

  void look() {
    for (std::size_t i = 0; i < verb_.axes.size(); ++i) {
      constexpr std::uint16_t max_age_ms = 100;
      auto state = context_.call(api::axis::GetState{verb_.axes[i], max_age_ms}, attending());
      if (state) {
        shown_[i] = {std::move(*state), {}};
      } else {
        message_ = state.error().message;
      }
    }
  }

  void draw() {
    const auto now = context_.host.now();
    if (now - drawn_at_ < draw_interval) return;
    drawn_at_ = now;
    look();
    constexpr const char* arrows[] = {"Left Right", "Down Up", "PgDn PgUp"};
    std::vector<std::string> lines{
        "hold an arrow to move; any other key stops; q ends this", "",
        keys_.makes_steps()
            ? fmt::format("steps of {}  (+ - another one, Tab: no steps)",
                          tmcl::plain_number(std::pow(10.0, keys_.step_power())))
            : fmt::format("{} % of the speed  (1..9, 0: 100 %, Tab: steps)", keys_.percent()),
        ""};
    for (std::size_t i = 0; i < verb_.axes.size(); ++i)
      lines.push_back(fmt::format("{:<11}{}  at {}  velocity {}", arrows[i], verb_.axes[i],
                                  position_text(shown_[i], verb_.internal),
                                  velocity_text(shown_[i], verb_.internal)));
    lines.insert(lines.end(), {"", message_});
    screen_.show(lines);
  }

  const verb::Jog& verb_;
  std::vector<JogSpeed> speeds_;
  FullScreen& screen_;
  Context& context_;
  JogKeys keys_;
  std::vector<AxisReading> shown_;
  std::string message_;
  tmcl::TimePoint drawn_at_{};
};

Result<ExitCode> run(const verb::Jog& verb, Context& context) {
  auto found = FullScreen::look_for(context.output.out_screen);
  if (!found) {
    found.error().hint = "'tmclctl move --by' needs none";
    return tl::unexpected(found.error());
  }
  std::vector<JogSpeed> speeds;
  for (const auto& axis : verb.axes) {
    auto speed = speed_of(verb, axis, context);
    if (!speed) return tl::unexpected(speed.error());
    speeds.push_back(std::move(*speed));
  }
  auto lease = HeldLease::take(verb.axes, lease_ttl_ms, context);
  if (!lease) return tl::unexpected(lease.error());
  Result<void> ended;
  {
    const auto screen = FullScreen::open(context.output.out_screen);
    if (screen) (*screen)->report_releases();
    ended = screen ? Jog(verb, std::move(speeds), **screen, context).run(*lease)
                   : tl::unexpected(screen.error());
  }
  const auto released = lease->release(context);
  if (ended && !released) return tl::unexpected(released.error());
  return ended.map([] { return ExitCode::done; });
}

constexpr const char* jog_help = R"(
Moves up to three axes while keys are held: Left and Right the first one, Down and Up the second, PgDn
and PgUp the third. 1 to 9 choose 10 to 90 % of --velocity, 0 all of it. Tab makes steps of them, one
for each press: + and - make them ten times longer or shorter, from 1 of the axis' unit, or from 1
microstep. Any other key stops all of them at once, and q ends this.

Where the terminal reports that a key is released (kitty, foot, ghostty, WezTerm: kitty's keyboard
protocol), the axis stops at once. Others report presses and repeats only: an axis goes on for 0.6 s
after a press, and for 0.15 s after each repeat; then its module stops it by itself. So it does when
this program, tmcld or the cable is gone. Nothing goes beyond soft limits. The axes are leased meanwhile. It needs a terminal.

  exit 0   ended; the axes were stopped
       4   a stop was not confirmed: an axis may still move to where it was told

  tmclctl jog x y
  tmclctl jog x --velocity 5mm/s
)";

}  // namespace

void add_jog(Grammar& grammar) {
  auto jog =
      grammar.verb<verb::Jog>("jog", access::acts, "Move axes while keys are held", jog_help, run);
  jog.words("AXIS", axis_meaning, texts(jog->axes));
  jog.option("--velocity", "VELOCITY", "At 100 % (default: max_velocity of the axis / 5)",
             text(jog->velocity));
  jog.internal(jog->internal);
  jog.object([](const verb::Jog& said, bool) {
    return said.axes.empty() || said.axes.size() > JogKeys::most_axes ? "name one to three AXES"
                                                                      : "";
  });
}

}  // namespace tmclctl
