#include "console_input.hpp"

#include <unistd.h>

#include <boost/asio/read_until.hpp>
#include <iostream>
#include <string>
#include <utility>

namespace tmclsim {

ConsoleInput::ConsoleInput(boost::asio::io_context& io, Answer answer)
    : answer_(std::move(answer)), input_(io, ::dup(STDIN_FILENO)) {}

void ConsoleInput::listen() {
  boost::asio::async_read_until(input_, buffer_, '\n', [this](const auto& error, std::size_t) {
    if (error) return;
    answer_lines();
    listen();
  });
}

void ConsoleInput::answer_lines() {
  std::istream stream(&buffer_);
  std::string line;
  std::getline(stream, line);
  const auto answer = answer_(line);
  if (!answer.empty()) std::cout << answer << std::endl;
}

}  // namespace tmclsim
