/// How long something took, over and over: counted by how long, never kept one by one.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "tmcl/clock.hpp"

namespace tmcld {

class Latency {
 public:
  /// Upper bounds of the buckets, in seconds; another bucket is for all that took longer.
  static constexpr std::array<double, 9> bounds_s{0.001, 0.002, 0.005, 0.01, 0.02,
                                                  0.05,  0.1,   0.5,   1.0};

  void note(tmcl::Duration took) {
    const auto seconds = std::chrono::duration<double>(took).count();
    std::size_t bucket = 0;
    while (bucket < bounds_s.size() && seconds > bounds_s[bucket]) ++bucket;
    ++counts_[bucket];
    sum_s_ += seconds;
  }
  /// Not cumulative; the last one is of what took longer than all bounds.
  const std::array<std::uint64_t, bounds_s.size() + 1>& counts() const { return counts_; }
  double sum_s() const { return sum_s_; }

 private:
  std::array<std::uint64_t, bounds_s.size() + 1> counts_{};
  double sum_s_ = 0;
};

}  // namespace tmcld
