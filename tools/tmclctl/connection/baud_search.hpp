/// Looks for modules on a serial port whose baud rate is not known. What is sent does nothing to a
/// module of any rate: tmcl/harmless_question.hpp.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "output/errors.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/heard.hpp"
#include "tmcl/version.hpp"

namespace tmclctl {

/// A port, and how to wait for what it brings.
class SearchedPort {
 public:
  virtual ~SearchedPort() = default;
  /// Opens it at this rate, anew if it is open.
  virtual Result<void> open(std::uint32_t baud) = 0;
  virtual Result<void> send(std::span<const std::uint8_t> bytes) = 0;
  /// How many bytes came; 0 if none did within this time.
  virtual Result<std::size_t> receive(std::span<std::uint8_t> into, tmcl::Duration at_most) = 0;
  virtual tmcl::TimePoint now() const = 0;
};

struct FoundAtRate {
  std::uint32_t baud = 0;
  std::uint8_t address = 0;
  tmcl::FirmwareVersion version;
};

struct BaudSearchOptions {
  std::uint8_t first = 1;
  std::uint8_t last = 255;
  /// What an address has to answer besides the time on the wire; more than 5 ms.
  tmcl::Duration reply_timeout = std::chrono::milliseconds(25);
};
/// How long a search that finds nothing takes.
tmcl::Duration longest_search(const BaudSearchOptions& options);

struct BaudSearchNews {
  std::function<void(const FoundAtRate&)> found;
  std::function<void(std::uint32_t baud, std::uint8_t address)> asked;
  std::function<bool()> cancelled;  ///< True ends the search.
};

/// Asks the first address at all rates, then the others, rate by rate, until modules answer at one.
/// Returns what came where none did: of the rate at which that says most.
Result<tmcl::HeardVerdict> search_bauds(SearchedPort& port, const BaudSearchOptions& options,
                                        const BaudSearchNews& news);

}  // namespace tmclctl
