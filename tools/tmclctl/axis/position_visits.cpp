#include "position_visits.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "command_line/form.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl {
namespace {

constexpr std::array<std::string_view, 3> approaches{"none", "up", "down"};
constexpr int digits_of_positions = 12;

double mean(const std::vector<double>& values) {
  const auto sum = std::accumulate(values.begin(), values.end(), 0.0);
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double spread(const std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto [least, greatest] = std::ranges::minmax(values);
  return greatest - least;
}

/// Of visits to one position, at least one.
PositionStatistics of_position(const std::vector<Reached>& visits) {
  PositionStatistics result{visits.front().visit.index};
  std::vector<double> all;
  std::array<std::vector<double>, approaches.size()> by_side;
  for (const auto& visit : visits) {
    result.target = visit.target;
    all.push_back(visit.reached - visit.target);
    by_side.at(static_cast<std::size_t>(visit.approach)).push_back(all.back());
  }
  result.count = all.size();
  result.mean_deviation = mean(all);
  for (const auto& side : by_side) result.spread = std::max(result.spread, spread(side));
  const auto& [none, up, down] = by_side;
  if (!up.empty() && !down.empty()) result.backlash = mean(down) - mean(up);
  return result;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const auto comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// By their places in scan_columns().
std::optional<Reached> read_row(std::string_view line) {
  constexpr std::size_t pass_cell = 1;
  constexpr std::size_t index_cell = 2;
  constexpr std::size_t approach_cell = 3;
  constexpr std::size_t target_cell = 7;
  constexpr std::size_t reached_cell = 8;
  constexpr std::size_t all_cells = 10;
  const auto cells = cells_of(line);
  if (cells.size() != all_cells) return std::nullopt;
  const auto side = std::ranges::find(approaches, cells[approach_cell]);
  const auto pass = parse_number<std::int32_t>(cells[pass_cell]);
  const auto index = parse_number<std::int32_t>(cells[index_cell]);
  const auto target = parse_number<double>(cells[target_cell]);
  const auto reached = parse_number<double>(cells[reached_cell]);
  if (side == approaches.end() || !pass || !index || !target || !reached) return std::nullopt;
  return Reached{
      {*pass, *index}, static_cast<Approach>(side - approaches.begin()), *target, *reached};
}

}  // namespace

std::vector<Visit> visits_of(std::int32_t steps, std::int32_t repeat, bool both_ways) {
  std::vector<Visit> visits;
  for (std::int32_t pass = 1; pass <= repeat; ++pass) {
    // The pass before has ended there.
    const std::int32_t first = both_ways && pass > 1 ? 1 : 0;
    for (auto index = first; index < steps; ++index) visits.push_back({pass, index});
    for (auto index = steps - 2; both_ways && index >= 0; --index) visits.push_back({pass, index});
  }
  return visits;
}

std::string_view name_of(Approach approach) {
  return approaches.at(static_cast<std::size_t>(approach));
}

ScanStatistics statistics_of(const std::vector<Reached>& visits) {
  ScanStatistics result;
  std::map<std::int32_t, std::vector<Reached>> by_index;
  for (const auto& visit : visits) by_index[visit.visit.index].push_back(visit);
  std::vector<double> backlashes;
  for (const auto& [index, there] : by_index) {
    const auto position = of_position(there);
    result.repeatability = std::max(result.repeatability, position.spread);
    if (position.backlash) backlashes.push_back(*position.backlash);
    result.positions.push_back(position);
  }
  if (!backlashes.empty()) result.backlash = mean(backlashes);
  return result;
}

std::string scan_columns(const std::string& unit) {
  return fmt::format(
      "utc,pass,index,approach,command_microsteps,position_microsteps,encoder,target_{0},"
      "reached_{0},deviation_{0}\n",
      unit);
}

std::string scan_row(const Reached& reached, const RowContext& context) {
  const auto number = [](double value) { return tmcl::plain_number(value, digits_of_positions); };
  return fmt::format(
      "{},{},{},{},{},{},{},{},{},{}\n", context.utc, reached.visit.pass, reached.visit.index,
      name_of(reached.approach), context.target_microsteps, context.position_microsteps,
      context.encoder ? std::to_string(*context.encoder) : "", number(reached.target),
      number(reached.reached), number(reached.reached - reached.target));
}

tl::expected<ScanFile, std::string> read_scan(std::string_view text, const std::string& about,
                                              const std::string& columns,
                                              const std::vector<Visit>& visits) {
  ScanFile file;
  bool has_columns = false;
  bool is_this_one = false;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string_view::npos;
       begin = end + 1) {
    const auto line = text.substr(begin, end + 1 - begin);
    if (line.starts_with('#')) {
      is_this_one = is_this_one || line == about;
    } else if (!has_columns) {
      has_columns = line == columns;
      if (!has_columns || !is_this_one)
        return tl::unexpected(std::string("it is of something else"));
    } else {
      const auto row = read_row(line.substr(0, line.size() - 1));
      const auto place = file.visits.size();
      if (!row || place >= visits.size() || row->visit != visits[place])
        return tl::unexpected(fmt::format("its row {} is not of this scan", place + 1));
      file.visits.push_back(*row);
    }
    if (has_columns) file.bytes = end + 1;
  }
  return file;
}

}  // namespace tmclctl
