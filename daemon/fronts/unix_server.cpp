#include "fronts/unix_server.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include "async/rest.hpp"
#include "async/spawn.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;

// With no descriptors left, accepting fails at once and for ever: not so often, then.
constexpr auto pause_after_failure = std::chrono::milliseconds(100);

}  // namespace

UnixServer::UnixServer(const boost::asio::any_io_executor& executor, SocketFile file,
                       std::shared_ptr<Gateway> gateway)
    : acceptor_(executor, Protocol(), file.release_descriptor()),
      file_(std::move(file)),
      gateway_(std::move(gateway)) {}

void UnixServer::start() { spawn(acceptor_.get_executor(), accept(shared_from_this())); }

void UnixServer::stop_accepting() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  file_.remove();
}

void UnixServer::finish_sessions() {
  for (const auto& [id, session] : sessions_) session->finish();
}

void UnixServer::close_sessions() {
  // A session that closes removes itself from the list.
  const auto sessions = sessions_;
  for (const auto& [id, session] : sessions) session->close();
}

awaitable<void> UnixServer::accept(std::shared_ptr<UnixServer> self) {
  while (self->acceptor_.is_open()) {
    boost::system::error_code error;
    auto socket = co_await self->acceptor_.async_accept(redirect_error(use_awaitable, error));
    if (!error) {
      self->take_in(std::move(socket));
      continue;
    }
    if (!self->acceptor_.is_open()) break;
    co_await rest(pause_after_failure);
  }
}

void UnixServer::take_in(Protocol::socket socket) {
  if (sessions_.size() >= max_clients) {
    gateway_->log(LogLevel::warning, "a client was turned away: there are too many");
    return;
  }
  const auto id = ++last_id_;
  auto session =
      std::make_shared<Session>(std::move(socket), gateway_, [weak = weak_from_this(), id] {
        if (const auto self = weak.lock()) {
          self->sessions_.erase(id);
        }
      });
  sessions_.emplace(id, session);
  session->start();
}

}  // namespace tmcld
