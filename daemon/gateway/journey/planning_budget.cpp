#include "gateway/journey/planning_budget.hpp"

namespace tmcld {
namespace {

// A plan that waits holds its text as it came, as parameters, and as what is to be read; a test
// measures that.
constexpr std::size_t bytes_of_a_text_byte = 4;
constexpr std::size_t bytes_of_a_plan = std::size_t{16} << 10;
constexpr std::size_t bytes_of_a_megabyte = std::size_t{1} << 20;

tmcl::Error full(const std::string& what, std::size_t used, std::size_t limit) {
  return tmcl::not_sent(
      tmcl::Errc::queue_full,
      what + ": " + std::to_string(used / bytes_of_a_megabyte) + " of " +
          std::to_string(limit / bytes_of_a_megabyte) + " MB of memory for planning are taken",
      "wait until some of them are answered before asking for more; 'planning_memory_mb' in the "
      "configuration sets how much there is");
}

}  // namespace

void PlanningBudget::End::operator()(const std::size_t* bytes) const {
  use->all -= *bytes;
  const auto found = use->of_clients.find(client);
  found->second -= *bytes;
  if (found->second == 0) use->of_clients.erase(found);
  delete bytes;
}

std::size_t PlanningBudget::bytes_for(std::size_t text_bytes) {
  return bytes_of_a_plan + text_bytes * bytes_of_a_text_byte;
}

tl::expected<PlanningBudget::Place, tmcl::Error> PlanningBudget::take(
    std::uint64_t client, const std::string& client_name, std::size_t bytes) {
  const auto found = use_->of_clients.find(client);
  const auto of_client = found == use_->of_clients.end() ? 0 : found->second;
  if (of_client > 0 && of_client + bytes > limit_ / 2)
    return tl::unexpected(
        full("plans of " + client_name + " wait or are made, or its paths and programs run",
             of_client, limit_ / 2));
  if (use_->all > 0 && use_->all + bytes > limit_)
    return tl::unexpected(
        full("plans of several clients wait or are made, or their paths and programs run",
             use_->all, limit_));
  auto held = std::make_unique<const std::size_t>(bytes);
  use_->of_clients[client] += bytes;
  use_->all += bytes;
  return Place(held.release(), End{use_, client});
}

}  // namespace tmcld
