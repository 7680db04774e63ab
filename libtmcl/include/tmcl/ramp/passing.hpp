/// When an axis will pass a place, to the tick.
///
/// Places are given as ways from where the axis is now, so nothing depends on what its position
/// counter says or on where that wraps.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

/// A generator whose movement between two changes is known well enough to look for a place in it.
template <class G>
concept Travelling = Generator<G> && requires(const G c) {
  /// The position counter wraps at so many bits.
  { G::position_bits } -> std::convertible_to<int>;
  /// At a velocity of so many units it moves by one microstep a tick at most.
  { G::velocity_of_a_microstep } -> std::convertible_to<std::int64_t>;
  /// -1, 0 or 1: where it is moving in this instant, be it ever so slowly.
  { c.heading() } -> std::same_as<int>;
};

/// The greatest way that can be told from its opposite, with room to spare.
template <Travelling G>
constexpr std::int64_t longest_way = std::int64_t{1} << (G::position_bits - 2);

/// The way from one state of an axis to another, which must be shorter than half the ring of its
/// positions.
template <Travelling G>
std::int64_t way_between(const G& from, const G& to) {
  constexpr int spare = 64 - G::position_bits;
  const auto raw = static_cast<std::uint64_t>(to.motion().position - from.motion().position);
  return static_cast<std::int64_t>(raw << spare) >> spare;
}

struct Passing {
  /// `forever`: it never will.
  Tick tick = forever;
  /// False: up to this tick it does not; later ticks were not searched.
  bool passed = false;
  bool operator==(const Passing&) const = default;
};

/// A movement takes some hundreds of changes at most; one that oscillates never comes to an end.
constexpr std::size_t changes_to_pass = 1000;

namespace detail {

template <Travelling G>
class PlaceSearch {
 public:
  PlaceSearch(const G& now, std::int64_t back, std::int64_t ahead)
      : start_(now), now_(now), back_(back), ahead_(ahead) {}

  Passing run(Tick limit, std::size_t most_changes) {
    for (; most_changes != 0; --most_changes) {
      const auto change = now_.next_change();
      if (now_.heading() == 0 && (now_.arrived() || now_.settled())) return {};
      if (now_.tick() >= limit) break;
      const auto found = through_stretch(std::min(change, limit));
      if (found != forever) return {found, true};
    }
    return {now_.tick(), false};
  }

 private:
  bool outside(const G& g) const {
    const auto way = way_between(start_, g);
    return way < -back_ || way > ahead_;
  }
  static G at(G g, Tick tick) {
    g.advance_to(tick);
    return g;
  }

  /// The velocity grows or falls all the way to the end, so it changes its sign once at most.
  Tick through_stretch(Tick end) {
    const int before = now_.heading();
    const int after = at(now_, end).heading();
    if (before * after < 0) {
      const auto turn = first_in(end, [&](const G& g) { return g.heading() != before; });
      for (const auto tick : {turn - 1, turn}) {
        const auto found = through_one_way(tick);
        if (found != forever) return found;
      }
    }
    return through_one_way(end);
  }

  /// Steps as long as they can be without going round the ring of positions unnoticed.
  Tick through_one_way(Tick end) {
    while (now_.tick() < end) {
      const auto step = std::min(end - now_.tick(), longest_step(end));
      const auto next = at(now_, now_.tick() + step);
      if (outside(next)) {
        return first_in(next.tick(), [&](const G& g) { return outside(g); });
      }
      now_ = next;
    }
    return forever;
  }

  Tick longest_step(Tick end) const {
    constexpr auto ring = static_cast<double>(longest_way<G>) * G::velocity_of_a_microstep;
    const auto speed =
        std::max(std::abs(now_.motion().velocity), std::abs(at(now_, end).motion().velocity));
    const auto ticks = ring / static_cast<double>(speed + 1);
    return ticks < 1 ? 1 : static_cast<Tick>(std::min(ticks, 0x1p62));
  }

  /// The first tick after now at which it is so; at `end` it is.
  template <class Predicate>
  Tick first_in(Tick end, Predicate is_so) const {
    auto from = now_;
    while (end - from.tick() > 1) {
      auto middle = at(from, from.tick() + (end - from.tick()) / 2);
      if (is_so(middle)) {
        end = middle.tick();
      } else {
        from = middle;
      }
    }
    return end;
  }

  const G start_;
  G now_;
  const std::int64_t back_;
  const std::int64_t ahead_;
};

}  // namespace detail

/// The first tick to come at which the axis is more than `back` behind or more than `ahead` before
/// where it is now, if nothing is written until then. Neither is negative, nor greater than
/// longest_way.
template <Travelling G>
Passing passing(const G& now, std::int64_t back, std::int64_t ahead, Tick limit = last_tick,
                std::size_t most_changes = changes_to_pass) {
  return detail::PlaceSearch<G>(now, back, ahead).run(std::min(limit, last_tick), most_changes);
}

/// The first tick to come at which it moves the other way, or not at all, if it moves now; the
/// first at which it moves, if it does not. `most_changes` are looked at.
template <Travelling G>
Passing turning(const G& now, Tick limit = last_tick, std::size_t most_changes = changes_to_pass) {
  limit = std::min(limit, last_tick);
  const int heading = now.heading();
  auto from = now;
  for (; most_changes != 0; --most_changes) {
    const auto change = from.next_change();
    if (from.arrived() || from.settled()) return {};
    if (from.tick() >= limit) break;
    auto end = std::min(change, limit);
    auto next = from;
    next.advance_to(end);
    if (next.heading() == heading) {
      from = next;
      continue;
    }
    while (end - from.tick() > 1) {
      auto middle = from;
      middle.advance_to(from.tick() + (end - from.tick()) / 2);
      if (middle.heading() != heading) {
        end = middle.tick();
      } else {
        from = middle;
      }
    }
    return {end, true};
  }
  return {from.tick(), false};
}

}  // namespace tmcl::ramp
