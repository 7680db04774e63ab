// get, set.
#include <fmt/format.h>

#include "asked.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {

VerbResult run(const verb::Get& verb, Room& room) {
  const auto got = room.target.get(verb.axis, verb.parameter);
  if (!got) return tl::unexpected(got.error());
  auto document = to_json(verb.axis, *got);
  auto line = fmt::format("{}\n", got->value);
  if (verb.in_units) {
    const auto shown = shown_value(*got, verb.axis, room.target);
    if (!shown) return tl::unexpected(shown.error());
    document["value_in_unit"] = shown->number;
    document["unit"] = shown->unit;
    line = fmt::format("{:.12g}{}\n", shown->number, shown->unit);
  }
  if (room.output.json) {
    print_json(document, room.output);
  } else {
    room.output.out << line;
  }
  return ExitCode::done;
}

VerbResult run(const verb::Set& verb, Room& room) {
  const auto value = asked_value(verb.value, verb.axis, verb.parameter, room.target);
  if (!value) return tl::unexpected(value.error());
  const auto set = room.target.set(verb.axis, verb.parameter, *value);
  if (!set) return tl::unexpected(set.error());
  if (room.output.json) print_json(to_json(verb.axis, *set), room.output);
  return ExitCode::done;
}

}  // namespace tmclctl
