// get, set.
#include "asked.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {

VerbResult run(const verb::Get& verb, Room& room) {
  const auto got = room.target.get(verb.axis, verb.parameter);
  if (!got) return tl::unexpected(got.error());
  if (room.output.json) {
    print_json(to_json(verb.axis, *got), room.output);
  } else {
    room.output.out << got->value << '\n';
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
