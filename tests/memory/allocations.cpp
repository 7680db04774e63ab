#include "memory/allocations.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#include <malloc.h>

namespace tmcld::test {
namespace {

struct Of {
  bool counts = false;
  std::uint64_t left = 0;  ///< Until one fails; 0: none does.
  bool and_all = false;
  bool has_failed = false;
  std::ptrdiff_t taken = 0;
  std::ptrdiff_t most = 0;
};
thread_local Of of_thread;

bool fails_now() {
  auto& of = of_thread;
  if (!of.counts || of.left == 0) return false;
  if (of.left > 1) {
    --of.left;
    return false;
  }
  of.has_failed = true;
  if (!of.and_all) of.left = 0;
  return true;
}

}  // namespace

Watched::Watched() { of_thread.counts = true; }
Watched::~Watched() { of_thread.counts = false; }

void fail_allocation(std::uint64_t n, bool and_all_that_follow) {
  of_thread.left = n;
  of_thread.and_all = and_all_that_follow;
  of_thread.has_failed = false;
}
bool end_failures() {
  of_thread.left = 0;
  return of_thread.has_failed;
}
bool has_failed() { return of_thread.has_failed; }

void begin_to_measure() { of_thread.taken = of_thread.most = 0; }
std::size_t taken_bytes() {
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(of_thread.taken, 0));
}
std::size_t most_bytes() { return static_cast<std::size_t>(of_thread.most); }

namespace {

void note_taken(void* memory) {
  auto& of = of_thread;
  if (!of.counts || memory == nullptr) return;
  of.taken += static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  of.most = std::max(of.most, of.taken);
}

void note_given_back(void* memory) {
  if (of_thread.counts && memory != nullptr)
    of_thread.taken -= static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
}

void* take(std::size_t size) {
  if (fails_now()) throw std::bad_alloc();
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  note_taken(memory);
  return memory;
}

void* take_aligned(std::size_t alignment, std::size_t size) {
  void* memory = nullptr;
  if (fails_now() || posix_memalign(&memory, alignment, size) != 0) return nullptr;
  note_taken(memory);
  return memory;
}

}  // namespace
}  // namespace tmcld::test

// Of this test program alone; the other forms of new and delete come here.
void* operator new(std::size_t size) { return tmcld::test::take(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

// Asio takes its memory by this one.
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return tmcld::test::take_aligned(alignment, size);
}

extern "C" void __libc_free(void* memory);
extern "C" void free(void* memory) noexcept {
  tmcld::test::note_given_back(memory);
  __libc_free(memory);
}
