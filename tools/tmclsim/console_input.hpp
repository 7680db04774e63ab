/// Lines from standard input, for the console.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/streambuf.hpp>

#include "sim/ports/scheduler.hpp"

namespace tmclsim {

/// Answers each line on standard output. The end of the input ends only the console.
class ConsoleInput {
 public:
  ConsoleInput(boost::asio::io_context& io, tmcl::sim::Scheduler& scheduler);
  void listen();

 private:
  /// A person writes no longer lines.
  static constexpr std::size_t longest_line = 1024;

  void answer_lines();

  tmcl::sim::Scheduler* scheduler_;
  boost::asio::posix::stream_descriptor input_;
  boost::asio::streambuf buffer_{longest_line};
};

}  // namespace tmclsim
