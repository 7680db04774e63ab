/// The memory of this test program: what fails when it is asked for, and how much is taken.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tmcld::test {

/// Of one thread. Everything counts while one of these lives; nothing does otherwise.
class Watched {
 public:
  Watched();
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;
  ~Watched();
};

/// Of what is watched on this thread, the n-th one from now on fails, from 1; and, if they shall,
/// all that follow.
void fail_allocation(std::uint64_t n, bool and_all_that_follow = false);
/// None fails any more. Whether one has.
bool end_failures();
bool has_failed();

/// Bytes that were taken on this thread and not given back, while it was watched, since the last
/// call of begin_to_measure(): now, and at most.
void begin_to_measure();
std::size_t taken_bytes();
std::size_t most_bytes();

}  // namespace tmcld::test
