/// Words that people type: those of a line, how a message names one, and "Did you mean ...?"
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tmcl {

/// Without the blanks between them.
std::vector<std::string_view> words_in(std::string_view line);

/// 'x'. An object, because of a std::string the standard library would quote it by a function of
/// the same name, which is found by the type alone.
inline constexpr auto quoted = [](std::string_view word) { return "'" + std::string(word) + "'"; };

/// The candidate that differs from `word` by the fewest edits (insertion, removal, exchange of one
/// letter, exchange of two neighbours), case ignored; empty if none is near enough to be what a
/// person meant: at most a third of the letters may differ, and of words under 6 letters the first
/// must be right. A candidate that goes on where the word ends is near. If none is, the only one
/// whose last words it is ("baud_rate" of "serial_baud_rate").
std::string_view closest_word(std::string_view word, std::span<const std::string_view> candidates);

/// The candidates that have `word` between their underscores, or at an end: "velocity" is in
/// "max_velocity" and "target_velocity". Case is ignored.
std::vector<std::string_view> words_with(std::string_view word,
                                         std::span<const std::string_view> candidates);

/// " Did you mean 'x'?", or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace tmcl
