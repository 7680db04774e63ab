/// Whose turn it is to have something computed: clients in turn, whatever each of them asks for.
#pragma once

#include <cstdint>
#include <memory>

#include <boost/asio/awaitable.hpp>

namespace tmcld {

/// One turn at a time. Thread safety: none. What it holds is bounded by those who wait.
class Turns {
  struct State;
  class Waiting;
  struct End {
    std::shared_ptr<State> of;
    std::uint64_t client = 0;
    void operator()(const void*) const noexcept;
  };

 public:
  /// For as long as it lives.
  using Turn = std::unique_ptr<const void, End>;

  Turns();

  /// Goes round: a client that waits behind others waits for one turn of each of them at most.
  boost::asio::awaitable<Turn> take(std::uint64_t client);

 private:
  std::shared_ptr<State> state_;
};

}  // namespace tmcld
