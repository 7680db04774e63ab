// get, set.
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
  const auto set = room.target.set(verb.axis, verb.parameter, verb.value);
  if (!set) return tl::unexpected(set.error());
  if (room.output.json) print_json(to_json(verb.axis, *set), room.output);
  return ExitCode::done;
}

}  // namespace tmclctl
