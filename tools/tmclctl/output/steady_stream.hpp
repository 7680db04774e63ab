/// A standard stream that a signal does not break.
///
/// A stream of the C++ library that a signal interrupts in a write takes no text any more: the
/// reason why a program has ended would be lost just then.
#pragma once

#include <array>
#include <ostream>
#include <streambuf>

namespace tmclctl {

/// Writes what a terminal shows line by line, the rest in blocks. An interrupted write is repeated
/// where it need not wait; where it would, it fails, so that Ctrl-C ends a program also where what
/// it writes is not read.
class DescriptorBuffer final : public std::streambuf {
 public:
  explicit DescriptorBuffer(int descriptor);

 protected:
  int_type overflow(int_type character) override;
  int sync() override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;

 private:
  bool write_out();

  int descriptor_;
  bool by_lines_;
  std::array<char, 4096> block_{};
};

/// `stream` writes to `descriptor` through a DescriptorBuffer for as long as this lives.
class SteadyStream {
 public:
  SteadyStream(std::ostream& stream, int descriptor)
      : stream_(stream), buffer_(descriptor), before_(stream.rdbuf(&buffer_)) {}
  ~SteadyStream() {
    stream_.flush();
    stream_.rdbuf(before_);
  }
  SteadyStream(const SteadyStream&) = delete;
  SteadyStream& operator=(const SteadyStream&) = delete;

 private:
  std::ostream& stream_;
  DescriptorBuffer buffer_;
  std::streambuf* before_;
};

}  // namespace tmclctl
