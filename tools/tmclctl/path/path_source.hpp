/// Files whose text moves axes, and what is wrong with them.
#pragma once

#include <string>

#include <boost/json/object.hpp>

#include "errors.hpp"
#include "screen.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmclctl::path {

/// The whole of a file of at most so many bytes.
Result<std::string> text_of(const std::string& file, std::size_t most_bytes);
constexpr std::size_t most_path_bytes = std::size_t{64} << 20U;
constexpr std::size_t most_mint_bytes = std::size_t{1} << 20U;

/// What a gateway says of a text: each problem printed, with what the command line can do about it.
Error explained(Error failure, const std::string& file, Output& output);
/// The "remarks" of a report.
void warn(const boost::json::object& report, Output& output);

/// `course` is "course" of path.plan: how long it is and takes, where it goes.
void print(const std::string& file, const boost::json::object& course, Output& output);
/// Draws the path, x over y, above the positions of all axes over time: `curve` is that of
/// path.plan.
Result<void> draw(const std::string& svg_path, const std::string& file,
                  const boost::json::object& course, const boost::json::object& curve);

}  // namespace tmclctl::path
