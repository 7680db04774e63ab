/// How much memory plans of paths and Mint programs may take that wait for their turn, and what
/// has been planned while it is run, in all and for each client. Beside that there is what one plan
/// takes while it is made, and the path that is kept.
///
/// Does no I/O. Thread safety: none. What it holds is bounded by the number of clients.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "tmcl/error.hpp"

namespace tmcld {

class PlanningBudget {
  struct Use {
    std::size_t all = 0;
    std::map<std::uint64_t, std::size_t> of_clients;
  };
  struct End {
    std::shared_ptr<Use> use;
    std::uint64_t client = 0;
    void operator()(const std::size_t* bytes) const;
  };

 public:
  /// What one plan takes, or what is run by it, for as long as this lives.
  using Place = std::unique_ptr<const std::size_t, End>;

  void set_limit(std::size_t bytes) { limit_ = bytes; }
  std::size_t taken() const { return use_->all; }

  /// What is counted for a text of so many bytes.
  static std::size_t bytes_for(std::size_t text_bytes);
  /// A client may have half of the limit; what is alone always finds room.
  /// Error: Errc::queue_full, which names what is full and by which client.
  [[nodiscard]] tl::expected<Place, tmcl::Error> take(std::uint64_t client,
                                                      const std::string& client_name,
                                                      std::size_t bytes);

 private:
  static constexpr std::size_t usual_bytes = std::size_t{64} << 20;

  std::size_t limit_ = usual_bytes;
  std::shared_ptr<Use> use_ = std::make_shared<Use>();
};

}  // namespace tmcld
