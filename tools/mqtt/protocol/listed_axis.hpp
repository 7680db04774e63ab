/// An axis as tmcld lists it.
#pragma once

#include <string>

namespace tmclmqtt {

struct ListedAxis {
  std::string name;
  std::string unit{};    ///< Empty: it has none.
  bool answers = false;  ///< Its module does.
};

}  // namespace tmclmqtt
