#include "async/turns.hpp"

#include <algorithm>
#include <list>
#include <map>
#include <optional>
#include <utility>

#include <boost/asio/this_coro.hpp>

#include "async/wake.hpp"

namespace tmcld {

struct Turns::State {
  void give_next() noexcept;
  void forget(std::uint64_t client) noexcept;

  std::optional<std::uint64_t> on_turn;
  std::list<Waiting*> waiting;  ///< In the order in which they came.
  /// Which turn of all each client had last; of one that has just come: the last one of all.
  std::map<std::uint64_t, std::uint64_t> last;
  std::uint64_t turns = 0;
};

/// One that wants a turn. Its coroutine may be destroyed at any time.
class Turns::Waiting {
 public:
  Waiting(std::shared_ptr<State> of, std::uint64_t client,
          const boost::asio::any_io_executor& executor)
      : of_(std::move(of)), client_(client), wake_(executor) {
    of_->waiting.push_back(this);
    try {
      of_->last.try_emplace(client_, of_->turns);
    } catch (...) {
      of_->waiting.remove(this);
      throw;
    }
    of_->give_next();
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  ~Waiting() {
    if (has_turn_) {
      End{of_, client_}(of_.get());
    } else {
      of_->waiting.remove(this);
      of_->forget(client_);
    }
  }

  std::uint64_t client() const { return client_; }
  void give() {
    has_turn_ = true;
    wake_.notify();
  }
  boost::asio::awaitable<void> wait() {
    while (!has_turn_) co_await wake_.wait();
  }
  Turn turn() {
    has_turn_ = false;
    return Turn(of_.get(), End{of_, client_});
  }

 private:
  std::shared_ptr<State> of_;
  std::uint64_t client_;
  Wake wake_;
  bool has_turn_ = false;
};

/// To the client whose last turn is the longest ago. Takes no memory.
void Turns::State::give_next() noexcept {
  if (on_turn || waiting.empty()) return;
  const auto next = std::ranges::min_element(
      waiting, {}, [this](const Waiting* one) { return last.at(one->client()); });
  auto& chosen = **next;
  waiting.erase(next);
  on_turn = chosen.client();
  last.at(chosen.client()) = ++turns;
  chosen.give();
}

void Turns::State::forget(std::uint64_t client) noexcept {
  const auto is_its = [&](const Waiting* one) { return one->client() == client; };
  if (on_turn != client && std::ranges::none_of(waiting, is_its)) last.erase(client);
}

void Turns::End::operator()(const void*) const noexcept {
  of->on_turn.reset();
  // A client that has come meanwhile goes first.
  of->last.at(client) = ++of->turns;
  of->give_next();
  of->forget(client);
}

Turns::Turns() : state_(std::make_shared<State>()) {}

boost::asio::awaitable<Turns::Turn> Turns::take(std::uint64_t client) {
  const auto executor = co_await boost::asio::this_coro::executor;
  Waiting waiting(state_, client, executor);
  co_await waiting.wait();
  co_return waiting.turn();
}

}  // namespace tmcld
