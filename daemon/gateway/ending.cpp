#include "gateway/ending.hpp"

#include <fmt/format.h>

#include "async/wait_until.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;

awaitable<void> end_journeys(Gateway& gateway) {
  if (!gateway.has_journeys()) co_return;
  gateway.end_journeys();
  co_await wait_until([&] { return !gateway.has_journeys(); }, time_for_journeys);
  if (!gateway.has_journeys()) co_return;
  gateway.log(LogLevel::error,
              "ending, although an axis on a line or path did not come to rest in time");
}

awaitable<void> wait_for_uploads(const Gateway& gateway) {
  const auto& uploads = gateway.uploads;
  if (uploads.empty()) co_return;
  gateway.log(
      LogLevel::warning,
      fmt::format("ending later, after the firmware upload to {}: waiting for that for {} s "
                  "at most",
                  fmt::join(uploads, ", "),
                  std::chrono::round<std::chrono::seconds>(time_for_uploads).count()));
  co_await wait_until([&] { return uploads.empty(); }, time_for_uploads);
  if (uploads.empty()) co_return;
  gateway.log(LogLevel::error,
              fmt::format("ending, although the firmware upload to {} is not complete: no firmware "
                          "runs there until it is uploaded again",
                          fmt::join(uploads, ", ")));
}

}  // namespace

awaitable<void> end_gateway(std::shared_ptr<Gateway> gateway) {
  gateway->refuse_new_calls();
  co_await end_journeys(*gateway);
  co_await wait_for_uploads(*gateway);
  co_await wait_until([&] { return gateway->stops_in_progress == 0; }, time_for_stops);
  gateway->close();
}

}  // namespace tmcld
