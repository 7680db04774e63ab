// coordinate: one verb for each thing that is done with the positions a module remembers.
#include "ask.hpp"

namespace tmclctl {

namespace {

constexpr const char* coordinate_help = R"(
Coordinates 0 to 20 are lost with the module's power, unless they are stored; 0 never is.

  tmclctl coordinate capture x 1
  tmclctl coordinate set x 2 12.5mm
  tmclctl coordinate move x 1
  tmclctl coordinate get x 1
  tmclctl coordinate store x; tmclctl coordinate load x
)";

constexpr const char* coordinate_start_help = R"(
Each motor goes to its own coordinate of this number. Only modules with several motors know this,
and how they are named on the wire is our reading of the manuals: try it where nothing can break.

  tmclctl coordinate set x 1 51200; tmclctl coordinate set y 1 25600
  tmclctl coordinate start 1 1 0 1 --arrive-together
)";

constexpr std::int32_t greatest_coordinate = 20;
constexpr std::uint8_t last_motor_to_start = 5;

AskForm add_coordinate(Grammar& grammar, const Form& group, const std::string& name,
                       const Access& access, const char* method, const std::string& description) {
  auto form = ask(grammar, group, name, access, method, description, coordinate_help);
  form.axis(form->axis);
  form.word("NUMBER", "Of the coordinate, 0 to 20", number(form->number, 0, greatest_coordinate));
  return form;
}

void add_all_coordinates(Grammar& grammar, const Form& group, const std::string& name,
                         const char* method, const std::string& description) {
  auto form = ask(grammar, group, name, access::acts, method, description, coordinate_help);
  form.axis(form->axis);
  form.optional_word("NUMBER", "Only this one, 1 to 20",
                     number(form->number, 1, greatest_coordinate));
}

}  // namespace

void add_coordinates(Grammar& grammar) {
  const auto group =
      grammar.group("coordinate", "Positions that modules remember by number", coordinate_help);
  auto set =
      add_coordinate(grammar, group, "set", access::acts, "coordinate.set", "Remember a position");
  set.word("POSITION", "With a unit, or microsteps where there is none; may be negative",
           text(set->position));
  set.internal(set->internal);
  auto get =
      add_coordinate(grammar, group, "get", access::reads, "coordinate.get", "Print a coordinate");
  get.internal(get->internal);
  auto capture = add_coordinate(grammar, group, "capture", access::acts, "coordinate.capture",
                                "Remember where the axis is");
  capture.internal(capture->internal);
  add_coordinate(grammar, group, "move", access::acts, "coordinate.move",
                 "Start a move to a coordinate");
  auto start = ask(grammar, group, "start", access::acts, "coordinate.start",
                   "Start several motors of a module together", coordinate_start_help);
  start.module(start->module);
  start.word("NUMBER", "Of the coordinate, 0 to 20", number(start->number, 0, greatest_coordinate));
  start.words("MOTOR", "One or more, 0 to 5", numbers(start->motors, 0, last_motor_to_start));
  start.flag("--arrive-together", "The nearer ones go slower, so that all arrive at once",
             start->interpolated);
  start.object([](const verb::Ask& said, bool) {
    return said.motors.empty() ? "name at least one motor" : "";
  });
  add_all_coordinates(grammar, group, "store", "coordinate.store",
                      "Copy those of the axis's module to its EEPROM");
  add_all_coordinates(grammar, group, "load", "coordinate.load", "And back");
}

}  // namespace tmclctl
