/// What axes do as CSV, row by row while it happens, under comments that say what it is of.
#pragma once

#include <string>
#include <vector>

#include "output/output_file.hpp"
#include "plot/recording.hpp"
#include "verbs/verbs.hpp"

namespace tmclctl {

/// Of the option --also.
constexpr const char* also_meaning = "Record these axis parameters as well, 8 at most";

/// An axis of which nothing was recorded yet: its name as the gateway has it, its unit unless
/// `internal` says otherwise, and further parameters by their standard names.
/// Errors: those of reading the axis and of reading these parameters.
Result<plot::Recording> begin_recording(const std::string& axis,
                                        const std::vector<std::string>& parameters, bool internal,
                                        Context& context);

/// The reading `time_s` after the recording has begun.
plot::Sample sample_of(const AxisReading& reading, double time_s, const plot::Recording& recording);

/// Lines that begin with "# ": versions, the time of day, and what each axis and parameter is.
/// What the gateway does not tell is left out.
std::string csv_comments(const std::vector<plot::Recording>& recordings, Context& context);

/// Rows of one axis or of several, which are alike in their further parameters.
class RecordingCsv {
 public:
  explicit RecordingCsv(Context& context) : context_(context) {}

  /// "-": standard output; empty: nothing is written. Before anything is sent.
  Result<void> open(const std::string& path);
  bool is_wanted() const { return !path_.empty(); }
  /// Finds out what stands above the rows, which is written with the first of them.
  void begin(const std::vector<plot::Recording>& recordings);
  void add(const plot::Recording& recording, const plot::Sample& sample);
  /// All rows of one that has ended.
  void add(const plot::Recording& recording, const plot::Shown& shown);
  /// Errors: something could not be written.
  const Result<void>& written() const { return written_; }

 private:
  void write(const std::string& text);

  Context& context_;
  std::string path_;
  OutputFile file_;
  plot::Rows rows_ = plot::Rows::of_one;
  std::string comments_;
  std::string columns_;
  bool has_begun_ = false;
  Result<void> written_;
};

}  // namespace tmclctl
