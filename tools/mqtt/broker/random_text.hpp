/// What makes names on a broker distinct, and cannot be guessed.
#pragma once

#include <string>

namespace tmclmqtt {

/// 32 hexadecimal digits, from the operating system. Throws if it gives none.
std::string random_text();

}  // namespace tmclmqtt
