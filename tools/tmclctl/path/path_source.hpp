/// Files whose text moves axes, and what is wrong with them.
#pragma once

#include <string>

#include "connection/staging.hpp"
#include "output/errors.hpp"
#include "output/screen.hpp"
#include "path/drawn_path.hpp"
#include "plot/curve.hpp"
#include "plot/shown.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmclctl::path {

/// The whole of a file of at most so many bytes.
Result<std::string> text_of(const std::string& file, std::size_t most_bytes);
constexpr std::size_t most_path_bytes = std::size_t{64} << 20U;
constexpr std::size_t most_mint_bytes = std::size_t{1} << 20U;

/// What a gateway says of a text: each problem printed, with what the command line can do about it.
Error explained(Error failure, const std::string& file, Output& output);
/// Hands a text over for the call of a method.
template <class Method>
Result<void> hand_over(const std::string& text, Method& params, Context& context,
                       const tmcl::client::CallOptions& options) {
  if (text.empty()) return params.text = text, Result<void>();
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  params.bytes = static_cast<std::uint32_t>(bytes.size());
  return stage<tmcl::api::path::Stage>(bytes, context, options);
}

/// What was done before an error came: `run` in its subject.
template <class Report>
Report part_done(const Error& error) {
  Report report;
  const auto* run = error.subject.if_contains("run");
  if (run != nullptr) tmcl::api::read_value(*run, report);
  return report;
}

/// "within the tolerance", or by how much not.
inline std::string tolerance_verdict(std::optional<double> exceeded_by) {
  if (!exceeded_by) return "within the tolerance";
  return tmcl::plain_number(*exceeded_by, 3) + " more than the tolerance";
}

/// How long a path is and takes, where it goes.
void print(const std::string& file, const tmcl::api::path::Course& course, Output& output);
/// What its shaper makes of it.
void print(const tmcl::api::path::Shaping& shaping, Output& output);
/// And what its jerk does.
void print(const tmcl::api::path::JerkLimit& limit, Output& output);
/// What is drawn of the axes over time.
struct Drawn {
  plot::Shown shown{};               ///< Empty: their positions, and only in a file.
  std::vector<plot::Mark> phases{};  ///< Of the legs; without them the slowest corners are marked.
  /// Of a path that was run: where its axes were seen, and where they were farthest off.
  std::optional<tmcl::api::path::Passage> passage{};
  /// Of a path that was only planned: what the file draws, for each point of the curve.
  std::vector<DrawnPath::Nearest> nearest{};
  double tolerance = 0;  ///< Of the plan.
};
/// Draws the path, x over y, above its axes over time.
std::string to_svg(const std::string& file, const tmcl::api::path::Course& course,
                   const tmcl::api::path::Curve& curve, const Drawn& drawn);
/// What is shown of all axes, in characters.
std::string drawing(const std::string& file, const tmcl::api::path::Course& course,
                    const tmcl::api::path::Curve& curve, const Drawn& drawn, const Screen& screen);

}  // namespace tmclctl::path
