/// What random scripts are made of.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

namespace tmcl::test {

template <class Integer = std::int64_t>
class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}

  Integer between(Integer low, Integer high) {
    return std::uniform_int_distribution<Integer>(low, high)(random_);
  }
  bool one_in(Integer n) { return between(1, n) == 1; }
  /// 0..greatest; magnitudes of all sizes are equally likely.
  Integer any_size(Integer greatest) {
    int bits = 0;
    while (greatest >> bits != 0) ++bits;
    const auto most = std::int64_t{1} << std::uniform_int_distribution(0, bits)(random_);
    return between(static_cast<Integer>(most / 2),
                   static_cast<Integer>(std::min<std::int64_t>(greatest, most - 1)));
  }
  /// 1..greatest, likewise.
  Integer positive(Integer greatest) { return any_size(greatest - 1) + 1; }
  Integer either_way(Integer value) { return one_in(2) ? value : -value; }

 private:
  std::mt19937_64 random_;
};

}  // namespace tmcl::test
