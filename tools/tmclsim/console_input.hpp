/// Lines from standard input, for the console.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/streambuf.hpp>

namespace tmclsim {

/// Answers each line on standard output. The end of the input ends only the console.
class ConsoleInput {
 public:
  /// What is said to a line; empty: nothing.
  using Answer = std::function<std::string(std::string_view line)>;

  ConsoleInput(boost::asio::io_context& io, Answer answer);
  void listen();

 private:
  /// A person writes no longer lines.
  static constexpr std::size_t longest_line = 1024;

  void answer_lines();

  Answer answer_;
  boost::asio::posix::stream_descriptor input_;
  boost::asio::streambuf buffer_{longest_line};
};

}  // namespace tmclsim
