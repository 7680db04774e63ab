/// How a message names a word, and "Did you mean ...?"
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tmcl {

/// 'x'
std::string quoted(std::string_view word);

/// The candidate that differs from `word` by the fewest edits (insertion, removal, exchange of one
/// letter), case ignored; empty if none is near enough to be what a person meant.
std::string_view closest_word(std::string_view word, std::span<const std::string_view> candidates);

/// " Did you mean 'x'?", or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace tmcl
