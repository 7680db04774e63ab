/// What tmcld calls its methods, in the words of the command line.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tmclctl {

struct MethodWord {
  std::string_view method;  ///< "axis.list"
  std::string_view verb;    ///< "axes", as it stands behind "tmclctl".
};

/// Every method of tmcld that has a point in its name.
std::span<const MethodWord> method_words();

/// Each name of a method becomes the verb that asks for it: tmcld's messages and hints are for its
/// clients, who know methods; here people read them, who know verbs.
std::string with_verbs(std::string_view text);

/// Each 'tmclctl VERB' of a verb that asks a gateway gets the options that name this one, such as
/// " --direct can:can0": it can be pasted as it stands. Empty: `text` as it is.
std::string with_gateway(std::string_view text, std::string_view options);

}  // namespace tmclctl
