/// The greatest value that trials bear. It says what to try, and is told what came of it: from a
/// small value up until a trial fails, then halfway between, then the best once more.
#pragma once

#include <map>
#include <optional>

namespace tmcl::plan {

class LimitSearch {
 public:
  struct Terms {
    double first = 1;          ///< Where it begins; not above `most`.
    double least = 0;          ///< Where even the first fails, nothing below this is tried.
    double most = 1;           ///< Nothing above this is tried.
    double growth = 1.4;       ///< From one that held to the next.
    double precision = 0.02;   ///< It ends so near to one that failed, in parts.
    unsigned repetitions = 2;  ///< So often the best is made again.
    unsigned trials = 40;      ///< There are no more than this.
  };
  explicit LimitSearch(Terms terms) : terms_(terms) {}

  /// What to try; nothing: it has ended.
  std::optional<double> next() const;
  /// What failed once is lost, and what is greater, however often that held before.
  void tried(double value, bool held);

  std::optional<double> greatest_held() const;
  std::optional<double> least_lost() const { return lost_; }

 private:
  std::optional<double> beyond(double best) const;

  Terms terms_;
  std::map<double, unsigned> held_;  ///< How often.
  std::optional<double> lost_;
  unsigned made_ = 0;
};

}  // namespace tmcl::plan
