#include "fronts/unix_server.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "fronts/descriptors.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;

// Between looks at whether all who have a place for stops have been answered.
constexpr auto place_look_interval = std::chrono::milliseconds(10);

}  // namespace

UnixServer::UnixServer(const boost::asio::any_io_executor& executor, SocketFile file,
                       std::shared_ptr<Gateway> gateway, std::size_t clients,
                       std::shared_ptr<FrontShare> share)
    : acceptor_(executor, Protocol(), file.release_descriptor()),
      file_(std::move(file)),
      gateway_(std::move(gateway)),
      most_clients_(clients),
      share_(std::move(share)) {}

void UnixServer::start() {
  if (file_.was_passed()) take_in_who_waits();
  spawn(acceptor_.get_executor(), accept(shared_from_this()));
}

void UnixServer::take_in_who_waits() {
  boost::system::error_code error;
  acceptor_.non_blocking(true, error);
  std::size_t cut_off = 0;
  // A client that comes while this goes on is for accept().
  for (int i = 0; i < SOMAXCONN; ++i) {
    Protocol::socket socket(acceptor_.get_executor());
    acceptor_.accept(socket, error);
    if (error) break;
    const bool has_spoken = socket.available(error) > 0;
    cut_off += has_spoken ? 1 : 0;
    if (!has_spoken && !is_full()) take_in(std::move(socket));
  }
  if (cut_off == 0) return;
  gateway_->log(LogLevel::warning,
                "clients that were cut off, because they had asked for something before tmcld "
                "served them: " +
                    std::to_string(cut_off) + "; nothing of it was done");
}

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

void UnixServer::review_rights() {
  const auto sessions = sessions_;
  for (const auto& [id, session] : sessions)
    if (session->has_lost_rights()) session->close();
}

bool UnixServer::has_calls_in_flight() const {
  return std::ranges::any_of(sessions_,
                             [](const auto& one) { return one.second->has_calls_in_flight(); });
}

bool UnixServer::has_output() const {
  return std::ranges::any_of(sessions_, [](const auto& one) { return one.second->has_output(); });
}

awaitable<void> UnixServer::accept(std::shared_ptr<UnixServer> self) {
  while (self->acceptor_.is_open()) {
    boost::system::error_code error;
    auto socket = co_await self->acceptor_.async_accept(redirect_error(use_awaitable, error));
    if (!error) {
      if (self->is_full()) co_await self->make_place_for_stop();
      self->take_in(std::move(socket));
      continue;
    }
    if (!self->acceptor_.is_open()) break;
    co_await rest(pause_after_failure);
  }
}

awaitable<void> UnixServer::make_place_for_stop() {
  gateway_->log_often(
      "full", LogLevel::warning,
      "there are " + std::to_string(most_clients_) + " clients: others can only stop axes");
  while (is_full() && for_stops_.size() >= places_for_stops && acceptor_.is_open()) {
    const auto now = gateway_->clock().now();
    const auto place = std::ranges::find_if(for_stops_, [&](const PlaceForStops& one) {
      return !sessions_.at(one.id)->has_calls_in_flight();
    });
    if (place == for_stops_.end()) {
      co_await rest(place_look_interval);
    } else if (now < place->since + time_to_ask) {
      co_await rest(place->since + time_to_ask - now);
    } else {
      // It takes itself off the lists.
      const auto session = sessions_.at(place->id);
      session->close();
    }
  }
}

void UnixServer::take_in(Protocol::socket socket) {
  const auto id = ++last_id_;
  const auto serves = is_full() ? Session::Serves::stops : Session::Serves::all;
  if (serves == Session::Serves::stops) for_stops_.push_back({id, gateway_->clock().now()});
  auto session = std::make_shared<UnixSession>(
      std::move(socket), gateway_, serves,
      [weak = weak_from_this(), id] {
        const auto self = weak.lock();
        if (!self) return;
        self->sessions_.erase(id);
        std::erase_if(self->for_stops_, [&](const PlaceForStops& one) { return one.id == id; });
      },
      share_);
  sessions_.emplace(id, session);
  session->start();
}

}  // namespace tmcld
