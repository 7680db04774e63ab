#include "output/steady_stream.hpp"

#include <cerrno>
#include <string_view>

#include <poll.h>
#include <unistd.h>

namespace tmclctl {
namespace {

bool takes_text_at_once(int descriptor) {
  pollfd writable{descriptor, POLLOUT, 0};
  return ::poll(&writable, 1, 0) > 0;
}

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const auto count = ::write(descriptor, text.data(), text.size());
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno != EINTR || !takes_text_at_once(descriptor)) {
      return false;
    }
  }
  return true;
}

}  // namespace

DescriptorBuffer::DescriptorBuffer(int descriptor)
    : descriptor_(descriptor), by_lines_(::isatty(descriptor) != 0) {
  setp(block_.data(), block_.data() + block_.size());
}

bool DescriptorBuffer::write_out() {
  const std::string_view text(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(block_.data(), block_.data() + block_.size());
  return write_all(descriptor_, text);
}

DescriptorBuffer::int_type DescriptorBuffer::overflow(int_type character) {
  if (!write_out()) return traits_type::eof();
  if (!traits_type::eq_int_type(character, traits_type::eof()))
    sputc(traits_type::to_char_type(character));
  return traits_type::not_eof(character);
}

int DescriptorBuffer::sync() { return write_out() ? 0 : -1; }

std::streamsize DescriptorBuffer::xsputn(const char* text, std::streamsize size) {
  const auto taken = std::streambuf::xsputn(text, size);
  const std::string_view line(text, static_cast<std::size_t>(taken));
  const bool is_shown = by_lines_ && line.find('\n') != std::string_view::npos;
  return is_shown && !write_out() ? 0 : taken;
}

}  // namespace tmclctl
