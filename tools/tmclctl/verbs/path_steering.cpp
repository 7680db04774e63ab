// path pause, path resume, path stop.
#include "ask.hpp"

namespace tmclctl {

namespace {

constexpr const char* path_steering_help = R"(
For paths that tmcld passes, by this client or another. A path in position mode pauses where it stands itself.
'resume' also lets a path go on that waits at M0 of its G-code.

  tmclctl path pause left
  tmclctl path resume
  tmclctl path stop
)";

/// One of the verbs for a path that is passed.
void add_steering(Grammar& grammar, const Form& path, const std::string& name, const char* method,
                  const std::string& description) {
  auto form =
      ask(grammar, path, name,
          access::tmcld_only(VerbEffect::acts,
                             "with --direct it is the program that began a path that leads it"),
          method, description, path_steering_help);
  form.words("AXIS", "One of each path; without any, all paths", texts(form->axes));
}

}  // namespace

void add_path_steering(Grammar& grammar, const Form& group) {
  add_steering(grammar, group, "pause", "path.pause", "Let axes stand on their path");
  add_steering(grammar, group, "resume", "path.resume", "Let them go on");
  add_steering(grammar, group, "stop", "path.stop", "End paths: the axes stop");
}

}  // namespace tmclctl
