/// A client on the unix socket, which says one message a line.
#pragma once

#include <boost/asio/local/stream_protocol.hpp>

#include "fronts/line_buffer.hpp"
#include "fronts/session.hpp"

namespace tmcld {

class UnixSession final : public Session {
 public:
  using Socket = boost::asio::local::stream_protocol::socket;

  UnixSession(Socket socket, std::shared_ptr<Gateway> gateway, Serves serves,
              std::function<void()> on_closed,
              std::shared_ptr<FrontShare> share = std::make_shared<FrontShare>());

  /// Says hello and begins to read; returns at once.
  void start();
  bool has_output() const override { return !batch_.empty() || Session::has_output(); }

 private:
  static boost::asio::awaitable<void> read(std::shared_ptr<UnixSession> self);
  static boost::asio::awaitable<void> write(std::shared_ptr<UnixSession> self);

  boost::asio::awaitable<void> outlive_input();
  bool has_hung_up();
  std::string take_output();
  void on_answer() override;
  void send_answers();
  void write_now();
  void disconnect() override;

  Socket socket_;
  LineBuffer lines_;
  std::string batch_;  ///< What is being written.
  bool is_writing_ = false;
  bool is_taking_input_ = false;
  Wake input_ended_;
};

}  // namespace tmcld
