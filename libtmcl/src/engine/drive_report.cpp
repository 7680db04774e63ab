#include "tmcl/drive_report.hpp"

#include <utility>

#include <fmt/format.h>

namespace tmcl {
namespace {

// A log has one line for it.
std::string in_one_line(Error error) {
  const auto hint = std::exchange(error.hint, {});
  return describe(error) + (hint.empty() ? "" : "; " + hint);
}

}  // namespace

std::string text_of(const plan::DriveFault& fault, const std::vector<std::string>& axes) {
  const auto what =
      fault.message.empty() && fault.error ? in_one_line(*fault.error) : fault.message;
  if (!fault.axis) return what;
  return axes.at(*fault.axis) + (fault.message.empty() ? ": " : " ") + what;
}

std::vector<std::string> remarks_of(const plan::DriveReport& report,
                                    const std::vector<std::string>& axes) {
  std::vector<std::string> remarks;
  for (const auto& unstopped : report.unstopped)
    remarks.push_back(axes.at(unstopped.axis) + " could not be stopped");
  for (const auto& [axis, before, why] : report.unrestored) {
    remarks.push_back(fmt::format("parameter {} of {} was {} before: {}", before.parameter,
                                  axes.at(axis), before.value, in_one_line(why)));
  }
  for (const auto& [word, why] : report.unswitched)
    remarks.push_back(fmt::format("M{} was not carried out: {}", word, why.message));
  return remarks;
}

}  // namespace tmcl
