/// Where paths, programs and lines are planned: on threads of their own.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "async/elsewhere.hpp"
#include "async/turns.hpp"

namespace tmcld {

class Planner {
 public:
  /// To be held while a path or a program is planned. One is planned at a time: it may take some
  /// seconds, and some hundred megabytes.
  boost::asio::awaitable<Turns::Turn> take_turn(std::uint64_t client) {
    return turns_.take(client);
  }
  /// What the function gives, or throws. It must hold all that it needs: see elsewhere().
  template <class Work>
  boost::asio::awaitable<std::invoke_result_t<Work>> plan(Work work) {
    return elsewhere(threads_, std::move(work));
  }
  /// Waits for what is being planned. To be called when no more is asked for.
  void join() { threads_.join(); }

 private:
  Turns turns_;
  /// A line, which takes no time to speak of, does not wait for a path.
  Workers threads_{2};
};

}  // namespace tmcld
